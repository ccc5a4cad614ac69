//! What a file may cost: counted on the array that stays, whose room was reserved once or grew from
//! smaller ones.

use mocap_io::{Motion, ParseErrorKind, parse_amc, parse_asf, parse_bvh};

/// Bytes that the values of a motion take, with the room behind them.
fn value_bytes(motion: Motion) -> usize {
    let (values, _) = motion.channels.into_raw_vec_and_offset();
    values.capacity() * size_of::<f64>()
}

/// The text of a BVH with one rotation and `rows`.
fn bvh(frames: u64, rows: &str) -> String {
    format!(
        "HIERARCHY ROOT a {{ OFFSET 0 0 0 CHANNELS 1 Xrotation }} MOTION\nFrames: {frames}\n\
         Frame Time: 0.01\n{rows}"
    )
}

/// While values are copied from a smaller room into a larger one, both are there: with a file of
/// short numbers at most half of ten times its size may stay.
const MAX_TIMES: usize = 5;

#[test]
fn short_numbers_take_no_more_than_four_bytes_a_byte() {
    let long = "0.12345678901234567\n".repeat(100);
    for text in [
        "0\n".repeat(200_000),
        long.clone() + &"0\n".repeat(200_000),
        "0\n".to_owned() + &long.repeat(50),
        "0 ".repeat(200_000),
        long.replace('\n', " ") + &"0 ".repeat(200_000),
    ] {
        let text = bvh(1, &text);
        let bytes = value_bytes(parse_bvh(text.as_bytes()).unwrap().motion);
        assert!(bytes <= MAX_TIMES * text.len(), "{bytes} of {}", text.len());
    }
}

#[test]
fn the_header_reserves_nothing() {
    let text = bvh(9_000_000_000_000_000, "1\n2\n");
    let bytes = value_bytes(parse_bvh(text.as_bytes()).unwrap().motion);
    assert!(bytes <= MAX_TIMES * text.len(), "{bytes}");
}

/// Bones of the skeleton whose motions name only the first.
const N_BONES: usize = 60;

fn skeleton() -> String {
    let bone = |i| format!("begin\nname b{i}\ndirection 0 1 0\nlength 1\ndof rx ry rz\nend\n");
    let bones: String = (0..N_BONES).map(bone).collect();
    let names: String = (0..N_BONES).map(|i| format!(" b{i}")).collect();
    format!(
        ":units\nlength 1\nangle deg\n:root\norder TX\n:bonedata\n{bones}:hierarchy\nroot{names}\n"
    )
}

#[test]
fn motions_of_few_bones_are_refused_before_they_fill_the_memory() {
    /// What a reader may take beside ten times the file.
    const SPARE: usize = 16 << 20;
    let asf = parse_asf(skeleton().as_bytes()).unwrap();
    let motion = |n: usize| -> String { (1..=n).map(|i| format!("{i}\nb0 0 0 0\n")).collect() };
    // What fits into the spare room is read, although the bones that are not named outweigh the file.
    let some = motion(5_000);
    let amc = parse_amc(some.as_bytes(), &asf).unwrap();
    assert_eq!(amc.motion.n_frames(), 5_000);
    let bytes = value_bytes(amc.motion);
    assert!(bytes <= SPARE + MAX_TIMES * some.len(), "{bytes}");
    let many = motion(100_000);
    let error = parse_amc(many.as_bytes(), &asf).unwrap_err();
    let ParseErrorKind::TooSparse {
        n_frames,
        n_channels,
        n_bytes,
    } = error.kind
    else {
        panic!("{error}");
    };
    assert_eq!((n_channels, n_bytes), (3 * N_BONES + 1, many.len()));
    let dense = n_frames * n_channels * size_of::<f64>();
    assert!(dense <= SPARE + 10 * many.len(), "{dense}");
    // A motion of all bones is never refused, however long.
    let row: String = (0..N_BONES).map(|i| format!("b{i} 0 0 0\n")).collect();
    let full: String = (1..=10_000)
        .map(|i| format!("{i}\nroot 0\n{row}"))
        .collect();
    let amc = parse_amc(full.as_bytes(), &asf).unwrap();
    assert_eq!(amc.motion.n_frames(), 10_000);
}

#[test]
fn warnings_are_listed_up_to_a_limit() {
    let text = skeleton() + &":x\n".repeat(100_000);
    let warnings = parse_asf(text.as_bytes()).unwrap().warnings;
    assert!(warnings.len() < 2_000, "{}", warnings.len());
    let n = 100_000 - (warnings.len() - 1);
    assert_eq!(
        warnings.last().unwrap().kind,
        mocap_io::WarningKind::More { n }
    );
}
