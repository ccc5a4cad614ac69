//! Arbitrary bytes as a saved model, once as they are and once under a right checksum, so that this does not keep the
//! fuzzer out. Whatever opens must be sound, walked, drawn and written again without harm.

#![no_main]

#[path = "../../tests/it/seal.rs"]
mod seal;

use bundles::{BundleModel, DeadEnds, RandomWalk};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    try_model(bytes);
    let mut sealed = bytes.to_vec();
    seal::reseal(&mut sealed);
    try_model(&sealed);
});

fn try_model(bytes: &[u8]) {
    let Ok(model) = BundleModel::from_bytes(bytes) else {
        return;
    };
    let graph = model.graph();
    assert_eq!(graph.debug_validate(), Ok(()));
    let again = model.to_bytes().expect("what is read can be written");
    assert_eq!(BundleModel::from_bytes(&again).as_ref(), Ok(&model));
    for dead_ends in [DeadEnds::Avoid, DeadEnds::Allow] {
        let walk = graph.random_walk(&RandomWalk {
            n_bundles: 5,
            start: None,
            dead_ends,
            seed: 0,
        });
        for piece in walk.iter().flat_map(|walk| &walk.pieces) {
            assert!(piece.frame(0).is_some());
            assert!(piece.frame(piece.n_frames()).is_some());
        }
    }
    let _ = graph.shortest_walk(0, graph.bundles().len().saturating_sub(1));
    let names = ["a"];
    let _ = graph.to_json(&names).len() + graph.to_svg(&names).len();
    let _ = graph.to_dot(&names).len() + graph.to_graphml(&names).len();
}
