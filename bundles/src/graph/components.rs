//! Strongly connected components (Tarjan 1972), without recursion.

use super::BundleGraph;

impl BundleGraph {
    /// The strongly connected components: ids in increasing order, components by their first id.
    ///
    /// Cost: O(bundles + edges).
    pub fn components(&self) -> Vec<Vec<usize>> {
        let mut search = Search {
            order: vec![None; self.bundles.len()],
            low: vec![0; self.bundles.len()],
            is_open: vec![false; self.bundles.len()],
            open: Vec::new(),
            n_seen: 0,
        };
        let mut components = Vec::new();
        for root in 0..self.bundles.len() {
            if search.order[root].is_none() {
                self.visit(root, &mut search, &mut components);
            }
        }
        components
            .iter_mut()
            .for_each(|ids: &mut Vec<usize>| ids.sort_unstable());
        components.sort_unstable();
        components
    }

    fn visit(&self, root: usize, search: &mut Search, components: &mut Vec<Vec<usize>>) {
        search.enter(root);
        // A bundle on the way, and how many of its edges are done.
        let mut way = vec![(root, 0)];
        while let Some((bundle, done)) = way.last_mut() {
            let bundle = *bundle;
            if let Some(edge) = self.edges_from(bundle).get(*done) {
                *done += 1;
                match search.order[edge.to] {
                    None => {
                        search.enter(edge.to);
                        way.push((edge.to, 0));
                    }
                    Some(order) if search.is_open[edge.to] => {
                        search.low[bundle] = search.low[bundle].min(order);
                    }
                    Some(_) => {}
                }
                continue;
            }
            way.pop();
            if let Some(&(before, _)) = way.last() {
                search.low[before] = search.low[before].min(search.low[bundle]);
            }
            if search.order[bundle] == Some(search.low[bundle]) {
                components.push(search.close(bundle));
            }
        }
    }
}

struct Search {
    /// When a bundle was entered; `None` before.
    order: Vec<Option<usize>>,
    /// The earliest open bundle known to be within reach.
    low: Vec<usize>,
    is_open: Vec<bool>,
    open: Vec<usize>,
    n_seen: usize,
}

impl Search {
    fn enter(&mut self, bundle: usize) {
        self.order[bundle] = Some(self.n_seen);
        self.low[bundle] = self.n_seen;
        self.n_seen += 1;
        self.is_open[bundle] = true;
        self.open.push(bundle);
    }

    /// Everything entered since `bundle` that is still open.
    fn close(&mut self, bundle: usize) -> Vec<usize> {
        let start = self.open.iter().rposition(|&open| open == bundle);
        let component = self.open.split_off(start.unwrap_or(0));
        component
            .iter()
            .for_each(|&closed| self.is_open[closed] = false);
        component
    }
}
