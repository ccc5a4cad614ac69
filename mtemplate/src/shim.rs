//! shim
use crate::{Match, MatchConfig, QuantizedTemplate};
/// shim
#[derive(Debug)]
pub struct MatchStream<'a> { t: &'a QuantizedTemplate, tau: f64, w: Vec<u64> }
impl<'a> MatchStream<'a> {
    /// shim
    pub fn new(t: &'a QuantizedTemplate, tau: f64) -> Self { Self { t, tau, w: vec![] } }
    /// shim
    pub fn push(&mut self, word: u64) -> Vec<Match> { self.w.push(word); vec![] }
    /// shim
    pub fn finish(self) -> Vec<Match> { let mut m = self.t.find_matches(&self.w, &MatchConfig{tau: self.tau, max_matches: usize::MAX}); m.sort_by_key(|m| m.span.end); m }
}
