//! What is on the screen: the frame buffer that Xvfb writes to a file (`-fbdir`, in the form of `xwd`), and where
//! in it a color is. So a test finds what it clicks on instead of guessing where it may be.

use std::path::Path;

/// A picture of the screen, `0xRRGGBB` a pixel.
pub struct Screen {
    pub size: [usize; 2],
    pixels: Vec<u32>,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    pub min: [i32; 2],
    /// Beyond the last.
    pub max: [i32; 2],
}

impl Spot {
    pub fn center(self) -> [i32; 2] {
        [0, 1].map(|axis| (self.min[axis] + self.max[axis]) / 2)
    }

    pub fn size(self) -> [i32; 2] {
        [0, 1].map(|axis| self.max[axis] - self.min[axis])
    }

    pub fn contains(self, at: [i32; 2]) -> bool {
        (0..2).all(|axis| (self.min[axis]..self.max[axis]).contains(&at[axis]))
    }
}

impl Screen {
    /// Reads the file of the frame buffer, 32 bits a pixel.
    pub fn read(file: &Path) -> Self {
        let bytes = std::fs::read(file).unwrap();
        let word = |idx: usize| u32::from_be_bytes(bytes[4 * idx..4 * idx + 4].try_into().unwrap()) as usize;
        let (header, width, height, bits, stride, n_colors) =
            (word(0), word(4), word(5), word(11), word(12), word(19));
        assert_eq!((bits, word(7)), (32, 0), "32 bits a pixel, the least byte first");
        // A color map of 12 bytes an entry stands before the pixels.
        let first = header + 12 * n_colors;
        let row = |y: usize| &bytes[first + y * stride..first + y * stride + 4 * width];
        let pixel = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap()) & 0x00ff_ffff;
        let pixels = (0..height).flat_map(|y| row(y).chunks_exact(4).map(pixel)).collect();
        Self { size: [width, height], pixels }
    }

    pub fn is(&self, [x, y]: [i32; 2], color: u32) -> bool {
        let [width, height] = self.size.map(|n| n as i32);
        // A step of rounding, in each channel.
        let near = |a: u32, b: u32| (a & 0xff).abs_diff(b & 0xff) <= 2;
        let found = || self.pixels[(y * width + x) as usize];
        (0..width).contains(&x)
            && (0..height).contains(&y)
            && [0, 8, 16].iter().all(|shift| near(found() >> shift, color >> shift))
    }

    /// The rectangles around connected pixels of a color, from the left.
    pub fn spots(&self, color: u32) -> Vec<Spot> {
        let [width, height] = self.size.map(|n| n as i32);
        let mut is_free: Vec<bool> =
            (0..width * height).map(|n| self.is([n % width, n / width], color)).collect();
        let mut found = Vec::new();
        for start in 0..width * height {
            if !std::mem::take(&mut is_free[start as usize]) {
                continue;
            }
            let mut spot = Spot { min: [i32::MAX; 2], max: [i32::MIN; 2] };
            let mut stack = vec![start];
            while let Some(n) = stack.pop() {
                let at = [n % width, n / width];
                spot.min = [spot.min[0].min(at[0]), spot.min[1].min(at[1])];
                spot.max = [spot.max[0].max(at[0] + 1), spot.max[1].max(at[1] + 1)];
                for [dx, dy] in [[-1, 0], [1, 0], [0, -1], [0, 1], [-1, -1], [1, 1], [-1, 1], [1, -1]] {
                    let next = [at[0] + dx, at[1] + dy];
                    let n = next[1] * width + next[0];
                    if (0..width).contains(&next[0])
                        && (0..height).contains(&next[1])
                        && std::mem::take(&mut is_free[n as usize])
                    {
                        stack.push(n);
                    }
                }
            }
            found.push(spot);
        }
        found.sort_by_key(|spot| spot.min);
        found
    }

    /// The middle of a part of this size that is all of a color, but for what covers a fiftieth of it.
    pub fn room(&self, color: u32, [width, height]: [i32; 2]) -> Option<[i32; 2]> {
        let [all_width, all_height] = self.size.map(|n| n as i32);
        let is_room = |left: i32, top: i32| {
            let mut other = 0;
            for y in (top..top + height).step_by(2) {
                other += (left..left + width).step_by(2).filter(|x| !self.is([*x, y], color)).count() as i32;
            }
            200 * other <= width * height
        };
        let lefts = || (0..all_width - width).step_by(8);
        let tops = (0..all_height - height).step_by(8);
        let mut places = tops.flat_map(|top| lefts().map(move |left| [left, top]));
        let found = places
            .find(|[left, top]| self.is([left + width / 2, top + height / 2], color) && is_room(*left, *top));
        found.map(|[left, top]| [left + width / 2, top + height / 2])
    }
}

#[test]
fn spots_and_room_are_found() {
    let mut screen = Screen { size: [40, 30], pixels: vec![0x0010_2030; 1200] };
    for y in 5..8 {
        for x in 10..20 {
            screen.pixels[y * 40 + x] = 0x00ff_0102;
        }
    }
    screen.pixels[29 * 40 + 39] = 0x00ff_0000;
    let spots = screen.spots(0x00ff_0000);
    assert_eq!(spots[0], Spot { min: [10, 5], max: [20, 8] });
    assert_eq!(spots[1], Spot { min: [39, 29], max: [40, 30] });
    assert_eq!((spots.len(), spots[0].center(), spots[0].size()), (2, [15, 6], [10, 3]));
    assert!(spots[0].contains([19, 7]) && !spots[0].contains([20, 7]));
    let room = screen.room(0x0010_2030, [30, 18]).unwrap();
    assert!(room[1] - 9 >= 8, "{room:?}");
    assert_eq!(screen.room(0x00ff_0000, [10, 10]), None);
}
