//! The colors of the canvas: one table for dark and one for light.
//!
//! A category colors a node's header, a port type its ports and wires. Text on headers is white in both, so
//! headers keep a contrast of 4 : 1 to it; ports are darker in the light table, for the same reason against
//! white. Tested by these contrasts.

use egui::Color32;

use super::scene::NodeShape;
use crate::graph::{Category, PortType};

const fn hex(rgb: u32) -> Color32 {
    Color32::from_rgb((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)
}

/// What is drawn in which color.
#[derive(Debug)]
pub struct Theme {
    pub is_dark: bool,
    pub background: Color32,
    pub grid: Color32,
    pub node: Color32,
    pub outline: Color32,
    pub text: Color32,
    pub weak: Color32,
    pub shadow: Color32,
    pub accent: Color32,
    pub stale: Color32,
    pub bad: Color32,
}

static DARK: Theme = Theme {
    is_dark: true,
    background: hex(0x17_19_1d),
    grid: hex(0x2a_2d_34),
    node: hex(0x2a_2d_34),
    outline: hex(0x0e_0f_12),
    text: hex(0xe6_e9_ee),
    weak: hex(0xa0_a7_b2),
    shadow: Color32::from_black_alpha(110),
    accent: hex(0xff_b4_54),
    stale: hex(0xe8_b3_39),
    bad: hex(0xf0_5d_5e),
};

static LIGHT: Theme = Theme {
    is_dark: false,
    background: hex(0xee_f0_f3),
    grid: hex(0xd3_d7_de),
    node: hex(0xff_ff_ff),
    outline: hex(0xb9_c0_cb),
    text: hex(0x1e_22_29),
    weak: hex(0x59_61_6e),
    shadow: Color32::from_black_alpha(45),
    accent: hex(0xd9_6c_00),
    stale: hex(0xb0_7a_00),
    bad: hex(0xc9_2a_2a),
};

impl Theme {
    /// Of the window as it is.
    pub fn of(ui: &egui::Ui) -> &'static Self {
        if ui.visuals().dark_mode { &DARK } else { &LIGHT }
    }

    /// A node's header.
    pub fn header(&self, node: &NodeShape) -> Color32 {
        if node.is_group { hex(0x3b_45_54) } else { self.category(node.category) }
    }

    /// Of a category; gray for an unknown kind.
    pub fn category(&self, category: Option<Category>) -> Color32 {
        match category {
            Some(Category::Volume) => hex(0x1f_7d_78),
            Some(Category::Light) => hex(0x9c_68_10),
            Some(Category::Geometry) => hex(0x5f_6b_7d),
            Some(Category::Camera) => hex(0x74_59_b0),
            Some(Category::Transport) => hex(0x32_69_b8),
            Some(Category::Image) => hex(0xab_42_6a),
            None => hex(0x6b_6b_6b),
        }
    }

    /// A port and its wires; gray for one that is not there.
    pub fn port(&self, kind: Option<PortType>) -> Color32 {
        let (dark, light) = match kind {
            Some(PortType::Volume) => (0x4f_c3_ba, 0x12_82_7a),
            Some(PortType::Medium) => (0x5b_a7_f2, 0x1f_6f_c4),
            Some(PortType::Environment) => (0xb3_d5_ff, 0x4a_74_a8),
            Some(PortType::Light) => (0xff_d4_5e, 0xa0_76_00),
            Some(PortType::Surface) => (0xb4_bc_c8, 0x62_6d_7c),
            Some(PortType::Camera) => (0xbd_a2_f2, 0x75_52_c0),
            Some(PortType::Ordinates) => (0xff_a0_4d, 0xc0_5f_00),
            Some(PortType::Importance) => (0xf0_8a_7d, 0xba_48_38),
            Some(PortType::Beams) => (0xf5_ec_7a, 0x86_7b_00),
            Some(PortType::Residual) => (0x8f_d6_8c, 0x37_84_34),
            Some(PortType::Image) => (0xf5_7b_ab, 0xbf_34_70),
            Some(PortType::Table) => (0xc9_d8_5a, 0x6b_78_00),
            None => (0x80_80_80, 0x80_80_80),
        };
        hex(if self.is_dark { dark } else { light })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::theme::contrast;
    use crate::nodes::catalog;

    #[test]
    fn colors_stand_out() {
        for theme in [&DARK, &LIGHT] {
            for text in [theme.text, theme.weak] {
                assert!(contrast(text, theme.node) > 4.5, "{text:?}");
            }
            for spec in catalog().0 {
                let header = contrast(theme.category(Some(spec.category)), Color32::WHITE);
                assert!(header > 4.0, "{} {header}", spec.category);
                for port in spec.inputs.iter().chain(spec.outputs) {
                    let port_color = contrast(theme.port(Some(port.kind)), theme.background);
                    assert!(port_color > 3.0, "{} {port_color}", port.kind);
                }
            }
        }
    }
}
