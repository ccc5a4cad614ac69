//! Graphs for programs.

use super::dot::clip_name;
use super::escape::quoted;
use super::{BundleGraph, Edge, Submotion};

impl BundleGraph {
    /// The graph as JSON: `{"bundles":[{"id","height","mean_frames","volume","spans":[SPAN]}],
    /// "edges":[{"from","to","passages":[{"exit","entry","transition"}]}],"loose":[SPAN]}`.
    ///
    /// A SPAN is `{"clip","start","end"}`: a name, and frames counted from the clip's start. `exit`
    /// and `entry` are indices of `spans`; `transition` is a SPAN or null. A volume beyond the
    /// range of `f64` is null. Clips without a name in `clip_names` are called by their index.
    pub fn to_json(&self, clip_names: &[&str]) -> String {
        let bundles = self.bundles().iter().enumerate().map(|(id, bundle)| {
            let volume = if bundle.volume.is_finite() {
                bundle.volume.to_string()
            } else {
                "null".to_owned()
            };
            format!(
                "{{\"id\":{id},\"height\":{},\"mean_frames\":{},\"volume\":{volume},\"spans\":{}}}",
                bundle.height(),
                bundle.mean_frames(),
                self.spans_json(&bundle.submotions, clip_names),
            )
        });
        let edges = self
            .edges()
            .iter()
            .map(|edge| self.edge_json(edge, clip_names));
        format!(
            "{{\"bundles\":{},\"edges\":{},\"loose\":{}}}",
            list(bundles),
            list(edges),
            self.spans_json(self.loose(), clip_names),
        )
    }

    fn edge_json(&self, edge: &Edge, clip_names: &[&str]) -> String {
        let passages = edge.passages.iter().map(|passage| {
            let transition = passage.transition.as_ref();
            let transition = transition.map(|submotion| self.span_json(submotion, clip_names));
            format!(
                "{{\"exit\":{},\"entry\":{},\"transition\":{}}}",
                passage.exit,
                passage.entry,
                transition.as_deref().unwrap_or("null"),
            )
        });
        let (from, to) = (edge.from, edge.to);
        format!(
            "{{\"from\":{from},\"to\":{to},\"passages\":{}}}",
            list(passages)
        )
    }

    fn spans_json(&self, submotions: &[Submotion], clip_names: &[&str]) -> String {
        list(
            submotions
                .iter()
                .map(|submotion| self.span_json(submotion, clip_names)),
        )
    }

    fn span_json(&self, submotion: &Submotion, clip_names: &[&str]) -> String {
        let span = self.in_clip(submotion);
        let name = quoted(&clip_name(submotion.clip, clip_names));
        format!(
            "{{\"clip\":\"{name}\",\"start\":{},\"end\":{}}}",
            span.start, span.end
        )
    }
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(","))
}
