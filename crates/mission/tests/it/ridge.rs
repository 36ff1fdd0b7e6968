//! A map with a ridge that blocks sight and paths, and a host that hears nothing.

use link::Response;
use mission::CoreHost;

pub struct SilentHost;

impl CoreHost for SilentHost {
    fn now_millis(&self) -> f64 {
        0.0
    }

    fn is_superseded(&mut self) -> bool {
        false
    }

    fn answer(&mut self, _response: Response) {}
}

/// 60 m by 20 m with a ridge from north to south that leaves a gap of 10 m in the south.
pub fn ridge() -> Vec<u8> {
    let mut text = "ncols 60\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 1\n".to_owned();
    for row in 0..20 {
        let is_high = |column: u32| row < 9 && (28..32).contains(&column);
        let heights: Vec<&str> = (0..60).map(|column| if is_high(column) { "6" } else { "0" }).collect();
        text.push_str(&heights.join(" "));
        text.push('\n');
    }
    text.into_bytes()
}
