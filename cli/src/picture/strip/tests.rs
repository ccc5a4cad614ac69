use ndarray::Array3;

use super::*;

/// A figure of two joints that stands on the floor and moves away from the camera.
fn positions(n_frames: usize) -> Array3<f32> {
    Array3::from_shape_fn((n_frames, 2, 3), |(frame, joint, axis)| match axis {
        1 => joint as f32,
        2 => frame as f32,
        _ => 0.0,
    })
}

fn stroke() -> Stroke {
    Stroke {
        from: 0,
        to: 1,
        colour: LEFT,
        width: 0.1,
    }
}

fn count(image: &Image, colour: Rgb) -> usize {
    image
        .pixels
        .chunks_exact(3)
        .filter(|pixel| *pixel == colour)
        .count()
}

#[test]
fn every_pose_is_drawn() {
    let config = StripConfig {
        n_poses: 4,
        camera: 0.0,
        ..StripConfig::default()
    };
    let image = skeleton_strip(positions(9).view(), &[stroke()], &config);
    assert_eq!(
        (image.width, image.height),
        (4 * config.cell_width, config.height)
    );
    assert_eq!(image.pixels.len(), image.width * image.height * 3);
    let one = StripConfig {
        n_poses: 1,
        ..config
    };
    let single = skeleton_strip(positions(9).view(), &[stroke()], &one);
    assert_eq!(count(&image, LEFT), 4 * count(&single, LEFT));
    assert!(count(&single, LEFT) > 100);
}

#[test]
fn nothing_to_draw_gives_an_empty_floor() {
    for (positions, n_poses) in [
        (Array3::zeros((0, 2, 3)), 3),
        (Array3::zeros((5, 0, 3)), 3),
        (Array3::zeros((5, 2, 2)), 3),
        (Array3::zeros((5, 2, 3)), 0),
        (Array3::from_elem((5, 2, 3), f32::NAN), 3),
    ] {
        let config = StripConfig {
            n_poses,
            ..StripConfig::default()
        };
        let image = skeleton_strip(positions.view(), &[stroke()], &config);
        assert_eq!(count(&image, LEFT), 0);
        assert!(image.to_png().is_ok());
    }
}

#[test]
fn strokes_to_missing_joints_are_skipped() {
    let missing = Stroke { to: 7, ..stroke() };
    let image = skeleton_strip(positions(3).view(), &[missing], &StripConfig::default());
    assert_eq!(count(&image, LEFT), 0);
    assert_eq!(strokes(&["root"], &[(0, 5)]), []);
}

#[test]
fn sides_are_told_by_name() {
    let names = [
        "root",
        "lowerback",
        "ltibia",
        "rradius",
        "LeftArm",
        "RightHand",
        "lclavicle",
    ];
    let bones: Vec<(usize, usize)> = (0..names.len()).map(|k| (0, k)).collect();
    let colours: Vec<Rgb> = strokes(&names, &bones)
        .iter()
        .map(|stroke| stroke.colour)
        .collect();
    assert_eq!(colours, [TRUNK, TRUNK, LEFT, RIGHT, LEFT, RIGHT, TRUNK]);
}

#[test]
fn the_camera_follows_the_figure() {
    // Facing +X: the left hip is at −Z.
    let mut hips = Array3::zeros((1, 2, 3));
    hips[[0, 0, 2]] = -0.1;
    hips[[0, 1, 2]] = 0.1;
    assert!((three_quarter(hips.view(), 0, 1, 30.0) - 120.0).abs() < 1e-3);
    assert_eq!(three_quarter(hips.view(), 0, 9, 30.0), 30.0);
}

#[test]
fn a_sheet_holds_its_strips_and_captions() {
    let strip = skeleton_strip(positions(3).view(), &[stroke()], &StripConfig::default());
    let rows = vec![
        ("a_1".to_owned(), strip.clone()),
        ("longer, with ü".to_owned(), strip.clone()),
    ];
    let sheet = contact_sheet(&rows);
    assert!(sheet.width > strip.width && sheet.height > 2 * strip.height);
    assert_eq!(count(&sheet, LEFT), 2 * count(&strip, LEFT));
    assert!(count(&sheet, TEXT) > 20);
    let empty = contact_sheet(&[]);
    assert!(empty.to_png().is_ok());
}

#[test]
fn a_png_decodes_to_the_picture() {
    let strip = skeleton_strip(positions(3).view(), &[stroke()], &StripConfig::default());
    let bytes = strip.to_png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(
        (info.width as usize, info.height as usize),
        (strip.width, strip.height)
    );
    assert_eq!(pixels, strip.pixels);
}
