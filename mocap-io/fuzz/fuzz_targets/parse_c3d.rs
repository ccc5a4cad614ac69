//! Arbitrary bytes as a C3D file. What is read has arrays that fit together, is missing as a whole where it
//! is missing, and takes memory in proportion to the bytes that are there.

#![no_main]

use libfuzzer_sys::fuzz_target;
use mocap_io::{C3d, guess_up, parse_c3d};

fuzz_target!(|bytes: &[u8]| {
    let c3d = match parse_c3d(bytes) {
        Ok(c3d) => c3d,
        Err(error) => {
            assert!(error.at.byte() <= bytes.len() && !error.to_string().is_empty());
            return;
        }
    };
    let markers = &c3d.markers;
    let (n_frames, n_markers) = (markers.n_frames(), markers.names.len());
    let n_others = c3d.other_points.names.len();
    assert!(n_frames > 0);
    assert_eq!(markers.positions.dim(), (n_frames, n_markers, 3));
    assert_eq!(markers.residuals.dim(), (n_frames, n_markers));
    assert_eq!(c3d.cameras.dim(), (n_frames, n_markers));
    assert_eq!(c3d.other_points.values.dim(), (n_frames, n_others, 3));
    assert_eq!(c3d.other_points.kinds.len(), n_others);
    assert_eq!(c3d.other_points.units.len(), n_others);
    for ((frame, marker), residual) in markers.residuals.indexed_iter() {
        let missing = [0, 1, 2].map(|axis| markers.positions[[frame, marker, axis]].is_nan());
        assert!(missing == [false; 3] || (missing == [true; 3] && residual.is_nan()));
    }
    if let Some(analog) = &c3d.analog {
        let n_samples = n_frames * analog.samples_per_frame;
        assert_eq!(analog.values.dim(), (n_samples, analog.names.len()));
        assert_eq!(analog.units.len(), analog.names.len());
    }
    for warning in &c3d.warnings {
        assert!(mocap_io::explain(warning.code()).is_some());
    }
    assert!(n_bytes(&c3d) <= (16 << 20) + 10 * bytes.len());

    let _ = guess_up(markers.positions.view());
    let gaps = markers.gaps();
    let (filled, which) = markers.filled(0.25);
    assert!(which.iter().all(|gap| gaps.contains(gap)));
    assert_eq!(filled.gaps().len(), gaps.len() - which.len());
    assert_eq!(markers.slice(0..n_frames).map(|m| m.gaps()), Some(gaps));
});

/// Of what grows with the file.
fn n_bytes(c3d: &C3d) -> usize {
    let texts = |names: &[String]| names.iter().map(|n| 24 + n.capacity()).sum::<usize>();
    let analog = c3d.analog.as_ref();
    let groups = c3d.parameters.groups.iter();
    c3d.markers.positions.len() * 4
        + c3d.markers.residuals.len() * 4
        + c3d.cameras.len()
        + c3d.other_points.values.len() * 4
        + analog.map_or(0, |a| a.values.len() * 4 + texts(&a.names) + texts(&a.units))
        + texts(&c3d.markers.names)
        + texts(&c3d.other_points.names)
        + groups.map(|g| g.parameters.len() * size_of::<mocap_io::Parameter>()).sum::<usize>()
}
