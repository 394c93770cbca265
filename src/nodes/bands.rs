//! A long stage as several submissions, between which a cancel is heard.
//!
//! The first submission is small; each further one is as large as would have taken [`PATIENCE`], up to what the stage
//! can submit at once. So a GPU, which is done sooner, gets one more submission each time than without, and a processor that
//! takes seconds for the stage still hears a cancel. How a stage is divided depends on the clock; what it computes does
//! not, because its parts keep their order. Tested by what is covered, whatever a submission takes.

use std::ops::Range;
use std::time::{Duration, Instant};

/// What a submission should take at most: who waits for it hardly notices.
const PATIENCE: Duration = Duration::from_millis(150);
/// The first submission is this part of the largest, unless it is asked for.
const FIRST: usize = 8;

/// Ranges that cover 0..n one after the other. The time from one to the next is that of the submission between.
pub(super) struct Bands {
    n: usize,
    first: usize,
    most: usize,
    last: Range<usize>,
    since: Instant,
}

impl Bands {
    /// Of 0..n, with no range longer than `most`.
    pub fn new(n: usize, most: usize) -> Self {
        let most = most.max(1);
        Self { n, first: most.div_ceil(FIRST), most, last: 0..0, since: Instant::now() }
    }

    /// The same with a first range of this length: where the largest one takes seconds.
    pub fn beginning_with(self, first: usize) -> Self {
        Self { first: first.clamp(1, self.most), ..self }
    }

    /// The next range, where the last one took so long.
    fn after(&mut self, took: Duration) -> Option<Range<usize>> {
        let len = match self.last.len() {
            0 => self.first,
            len => next_len(len, took, self.most),
        };
        let first = self.last.end;
        self.last = first..(first + len).min(self.n);
        (!self.last.is_empty()).then(|| self.last.clone())
    }
}

impl Iterator for Bands {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        let band = self.after(self.since.elapsed());
        self.since = Instant::now();
        band
    }
}

/// As long as would have taken [`PATIENCE`], where `len` took so long.
fn next_len(len: usize, took: Duration, most: usize) -> usize {
    let wanted = len as f64 * PATIENCE.as_secs_f64() / took.as_secs_f64().max(1e-6);
    (wanted as usize).clamp(1, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_is_covered_once_and_in_order() {
        for (n, most, took_ms) in
            [(0, 5, 0), (1, 1, 0), (100, 7, 0), (1000, 1000, 0), (40, 16, 300), (3, 0, 0)]
        {
            let mut end = 0;
            let mut n_bands = 0;
            let mut bands = Bands::new(n, most);
            while let Some(band) = bands.after(Duration::from_millis(took_ms)) {
                assert!(band.start == end && !band.is_empty() && band.len() <= most.max(1));
                (end, n_bands) = (band.end, n_bands + 1);
            }
            assert_eq!(end, n);
            // Where nothing takes time there is one small band, and then the largest.
            assert!(took_ms > 0 || most == 0 || n_bands <= 1 + n.div_ceil(most), "{n} {most}: {n_bands}");
        }
    }

    #[test]
    fn the_first_band_can_be_asked_for() {
        for (asked, first) in [(5, 0..5), (0, 0..1), (1000, 0..100)] {
            assert_eq!(Bands::new(100, 100).beginning_with(asked).after(Duration::ZERO), Some(first));
        }
        assert_eq!(Bands::new(100, 100).after(Duration::ZERO), Some(0..13));
    }

    #[test]
    fn bands_take_as_long_as_one_may_wait() {
        assert_eq!(next_len(8, Duration::from_millis(300), 100), 4);
        assert_eq!(next_len(8, Duration::from_millis(75), 100), 16);
        assert_eq!(next_len(8, Duration::ZERO, 100), 100);
        assert_eq!(next_len(1, Duration::from_secs(9), 100), 1);
    }
}
