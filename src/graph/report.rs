//! What a node says of its own run: which rules it followed and why, how large its grid is, and what its
//! stages move.
//!
//! A node reports while it runs; the report is cached with its outputs, so that a node that did not run
//! again still tells it. Whoever foretells a run (`tyndall explain`) gets the same report from the same
//! functions. Decisions are sentences for people with a stable `rule` for scripts. Tested in `eval`.

/// What a node says of its run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// What the scene requires and what was left out.
    pub decisions: Vec<Decision>,
    /// Cells of its grid along x, y, z.
    pub cells: Option<[usize; 3]>,
    /// Channels of color that are computed.
    pub channels: Option<usize>,
    /// Size of its outputs, where a run was only foretold in bytes.
    pub bytes: Option<u64>,
    /// What its stages move, where that is known before they run.
    pub stages: Vec<StageWork>,
}

/// Something that a scene requires, or that is left out because it does not.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Decision {
    /// Name of the rule, for scripts.
    pub rule: &'static str,
    /// Whether `what` is computed; else it is left out.
    pub kept: bool,
    /// What is computed or left out.
    pub what: String,
    /// Why.
    pub reason: String,
    /// What that rests on, as it was found.
    pub data: String,
}

/// What all runs of a stage move together.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct StageWork {
    /// The stage.
    pub stage: &'static str,
    /// How often it runs.
    pub runs: usize,
    /// What its threads read and write, caches not counted in bytes; `None` where only the run shows it.
    pub moved_bytes: Option<u64>,
}

impl Decision {
    /// `what` is computed.
    pub fn kept(
        rule: &'static str,
        what: impl Into<String>,
        reason: impl Into<String>,
        data: impl Into<String>,
    ) -> Self {
        Self { rule, kept: true, what: what.into(), reason: reason.into(), data: data.into() }
    }

    /// `what` is not computed.
    pub fn left_out(
        rule: &'static str,
        what: impl Into<String>,
        reason: impl Into<String>,
        data: impl Into<String>,
    ) -> Self {
        Self { kept: false, ..Self::kept(rule, what, reason, data) }
    }
}
