use bundles::ndarray::Array2;
use bundles::{
    BundleModel, EnvelopeError, ExtractOptions, MappingOptions, ModelErrorKind, Partition, extend,
    extract, map_frames, spell,
};
use proptest::prelude::*;

use crate::graph_laws::graph_of;
use crate::mapping_laws::{Mapped, mapped};
use crate::seal;

pub(crate) fn model_of(mapped: &Mapped) -> BundleModel {
    let (mapping, _) = graph_of(mapped);
    let (string, partition) = (mapped.case.string.clone(), mapped.partition.clone());
    BundleModel::new(string, mapped.extraction, partition, mapping).unwrap()
}

proptest! {
    #[test]
    fn reading_gives_what_was_written(mapped in mapped()) {
        let model = model_of(&mapped);
        let read = BundleModel::from_bytes(&model.to_bytes().unwrap()).unwrap();
        prop_assert_eq!(&read, &model);
        prop_assert_eq!(read.graph(), &graph_of(&mapped).1);
    }

    #[test]
    fn a_flipped_bit_is_found(mapped in mapped(), at: prop::sample::Index, bit in 0_u8..8) {
        let mut bytes = model_of(&mapped).to_bytes().unwrap();
        let at = at.index(bytes.len());
        bytes[at] ^= 1 << bit;
        prop_assert!(BundleModel::from_bytes(&bytes).is_err());
    }

    #[test]
    fn what_opens_under_a_right_checksum_is_sound(
        mapped in mapped(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = model_of(&mapped).to_bytes().unwrap();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        seal::reseal(&mut bytes);
        if let Ok(model) = BundleModel::from_bytes(&bytes) {
            prop_assert_eq!(model.graph().debug_validate(), Ok(()));
            let again = model.to_bytes().unwrap();
            prop_assert_eq!(BundleModel::from_bytes(&again), Ok(model));
        }
    }

    #[test]
    fn an_extended_model_keeps_its_spans(mapped in mapped(), more in prop::collection::vec(0_u32..2, 0..40)) {
        let model = model_of(&mapped);
        let (string, options) = (&mapped.case.string, *model.options());
        let n_frames = string.runs().last().map_or(0, |run| run.frames.end);
        let mut labels = vec![0; n_frames];
        for run in string.runs() {
            labels[run.frames.clone()].fill(run.letter.label());
        }
        let n_letters = mapped.case.distances.nrows() as u32;
        labels.extend(more.iter().map(|label| label % n_letters));
        let mut clips = model.graph().clips().to_vec();
        clips.push(n_frames..labels.len());
        let longer = spell(&labels, &clips).unwrap();
        let access = mapped.case.access();
        let partition = extend(model.partition(), &longer, &access, &options).unwrap();
        let poses = Array2::from_shape_fn((labels.len(), 2), |(frame, dim)| (frame * 7 % (5 + dim)) as f64);
        let fixed = MappingOptions { fixed: model.mapping().clone(), ..MappingOptions::default() };
        let mapping = map_frames(&longer, &partition, poses.view(), &fixed).unwrap();
        let longer = BundleModel::new(longer, options, partition, mapping).unwrap();
        prop_assert_eq!(longer.graph().debug_validate(), Ok(()));
        for (old, new) in model.graph().bundles().iter().zip(longer.graph().bundles()) {
            prop_assert!(old.submotions.iter().all(|submotion| new.submotions.contains(submotion)));
        }
        for old in model.graph().loose() {
            prop_assert!(longer.graph().loose().contains(old));
        }
    }
}

fn small() -> BundleModel {
    let string = spell(&[0, 0, 1, 2, 0, 1, 1, 2], &[0..4, 4..8]).unwrap();
    let apart = Array2::from_shape_fn((3, 3), |(a, b)| a.abs_diff(b) as f64);
    let access = bundles::Accessibility::new(apart.view(), 0.0).unwrap();
    let options = ExtractOptions::new(3);
    let partition = extract(&string, &access, &options).unwrap();
    let poses = Array2::zeros((8, 1));
    let mapping = map_frames(
        &string,
        &partition,
        poses.view(),
        &MappingOptions::default(),
    );
    BundleModel::new(string, options, partition, mapping.unwrap()).unwrap()
}

#[track_caller]
fn check(bytes: &[u8], at: usize, kind: impl Into<ModelErrorKind>) {
    let error = BundleModel::from_bytes(bytes).unwrap_err();
    assert_eq!((error.at, error.kind), (at, kind.into()));
}

#[test]
fn headers_say_what_is_wrong() {
    let bytes = small().to_bytes().unwrap();
    let truncated = |what, expected: usize, found: usize| EnvelopeError::Truncated {
        what,
        expected: expected as u64,
        found: found as u64,
    };
    check(&bytes[..5], 5, truncated("header", 28, 5));
    let n = bytes.len();
    check(&bytes[..n - 1], n - 1, truncated("payload", n - 28, n - 29));
    let longer = [&bytes[..], b"x"].concat();
    check(&longer, n, EnvelopeError::Trailing { found: 1 });
    let mut other = bytes.clone();
    other[..8].copy_from_slice(b"MOTIFSHD");
    let found = "MOTIFSHD".to_owned();
    check(&other, 0, EnvelopeError::Magic { found });
    let mut later = bytes.clone();
    later[8] = 9;
    check(
        &later,
        8,
        EnvelopeError::Version {
            expected: 1,
            found: 9,
        },
    );
    let mut changed = bytes;
    changed[n - 1] ^= 1;
    let error = BundleModel::from_bytes(&changed).unwrap_err();
    let is_checksum = matches!(
        error.kind,
        ModelErrorKind::Envelope(EnvelopeError::Checksum { .. })
    );
    assert!(is_checksum && error.at == 20);
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let model = small();
    let new = |partition: Partition| {
        let (string, mapping) = (model.string().clone(), model.mapping().clone());
        BundleModel::new(string, *model.options(), partition, mapping).map_err(|e| e.kind)
    };
    assert_eq!(new(model.partition().clone()), Ok(model.clone()));
    let empty = ModelErrorKind::Uncovered {
        expected: 4,
        found: 0,
    };
    assert_eq!(new(Partition::default()), Err(empty));
    let mut lonely = model.partition().clone();
    let single = lonely.bundles[0].members.pop().unwrap();
    lonely.degenerate.push(single);
    assert_eq!(new(lonely), Err(ModelErrorKind::Bundle { bundle: 0 }));
    let loose = model
        .partition()
        .substrings()
        .flat_map(|s| [(s.first, s.first + 1), (s.first + 1, s.last)]);
    let degenerate = loose
        .map(|(first, last)| bundles::Substring { first, last })
        .collect();
    let split = Partition {
        bundles: vec![],
        degenerate,
    };
    assert_eq!(
        new(split),
        Err(ModelErrorKind::Degenerate { first: 1, last: 2 })
    );
}
