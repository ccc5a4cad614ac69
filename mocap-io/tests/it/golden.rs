//! Published numbers: the sensor channels that Fox, Hughes, Sudderth and Jordan (2014) made of six CMU
//! trials ("mocap6"). A value is the mean of 12 frames of a channel, minus the channel's mean over the
//! whole trial. Block 0 stands in their table of predecessors, block `n + 1` in row `n` of the other.

use std::fs;

use mocap_io::{Axis, Channel, Motion, parse_amc, parse_asf};

use crate::real::data;

/// Frames per block: 120 Hz were brought down to 10 Hz.
const BLOCK: usize = 12;
/// The table has 12 significant digits of values below 100.
const PRINTED: f64 = 1e-9;

const CHANNELS: [(&str, Channel); 12] = [
    ("root", Channel::Translation(Axis::Y)),
    ("lowerback", Channel::Rotation(Axis::X)),
    ("lowerback", Channel::Rotation(Axis::Y)),
    ("upperneck", Channel::Rotation(Axis::Y)),
    ("rhumerus", Channel::Rotation(Axis::Z)),
    ("rradius", Channel::Rotation(Axis::X)),
    ("lhumerus", Channel::Rotation(Axis::Z)),
    ("lradius", Channel::Rotation(Axis::X)),
    ("rtibia", Channel::Rotation(Axis::X)),
    ("rfoot", Channel::Rotation(Axis::X)),
    ("ltibia", Channel::Rotation(Axis::X)),
    ("lfoot", Channel::Rotation(Axis::X)),
];

/// Trial, block, and the published values of the channels.
#[rustfmt::skip]
const PUBLISHED: [(&str, usize, [f64; 12]); 5] = [
    ("13_29", 0, [-1.69991641405, -0.151458972125, 0.371675911085, 2.22541107092, -8.60968589058, -38.014746973,
        10.089644148, -25.723661497, 29.9122998911, -18.15752822, 30.3542540287, -17.55153746]),
    ("13_29", 1, [-0.697724747387, -3.02570063879, 0.074385244418, 1.99589632092, 4.38124744276, -29.8622553063,
        -2.44901418529, -13.145836497, 19.9592748911, -9.66409488669, 19.9734706954, -9.48213745998]),
    ("13_29", 101, [0.81974191928, -7.74115730546, 0.320326744418, 1.68117148759, 37.3818431261, -47.5677553063,
        -33.507086752, -41.712186497, -25.3066084422, 4.44474677998, -28.6448459713, -8.09612912665]),
    ("13_29", 299, [1.26899191928, 2.49007436121, -7.56187742225, 1.60996390425, 16.6151307761, 4.157553027,
        38.0181858147, 73.4161051697, 62.0871248911, 12.04552428, -20.3925043046, 3.72387920669]),
    ("14_20", 200, [-0.882857321275, -8.90975598234, 0.0252248789535, 1.03368892316, 22.4697066729, 26.3325671835,
        -29.4542525681, 25.040262317, 5.52858830965, -9.04745650157, 6.13826956072, -14.734827395]),
];

fn column(motion: &Motion, bone: &str, channel: Channel) -> Vec<f64> {
    let joint = motion.skeleton.find(bone).unwrap();
    let channels = &motion.skeleton.joints()[joint].channels;
    let within = channels.iter().position(|&c| c == channel).unwrap();
    let first = motion.skeleton.first_channel(joint).unwrap();
    motion.channels.column(first + within).to_vec()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn real_amc_channels_agree_with_published_numbers() {
    let Some(data) = data() else { return };
    for (trial, block, published) in PUBLISHED {
        let subject = &trial[..2];
        let folder = data.join("cmu").join(subject);
        let asf = fs::read(folder.join(subject).with_extension("asf")).unwrap();
        let asf = parse_asf(&asf).unwrap();
        let amc = fs::read(folder.join(trial).with_extension("amc")).unwrap();
        let motion = parse_amc(&amc, &asf).unwrap().motion;
        for ((bone, channel), expected) in CHANNELS.into_iter().zip(published) {
            let values = column(&motion, bone, channel);
            let found = mean(&values[block * BLOCK..(block + 1) * BLOCK]) - mean(&values);
            assert!(
                (found - expected).abs() < PRINTED,
                "{trial}, block {block}, {bone} {channel}: {found} is not {expected}"
            );
        }
    }
}
