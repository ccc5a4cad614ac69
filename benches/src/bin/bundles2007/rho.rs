//! ρ = 2 beside ρ = 1.

use anyhow::Result;
use cli::output::table;

use crate::takes::{CLOSURES, Sets, Summary, percent};

/// Bundles of boxing at ρ = 2 that section 5 tells of: height and mean frames.
const BOXING: &str = "6x69 3x89 2x51 4x42 6x23";

/// Bundles shown.
const SHOWN: usize = 5;

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let mut rows = table(&[
        "",
        "closure",
        "bundles",
        "",
        "submotions",
        "",
        "frames",
        "",
        "in bundles",
        "",
        "fewer",
        "longer",
        "largest at 2",
    ]);
    rows.add_row(["rho", "", "1", "2", "1", "2", "1", "2", "", "", ""]);
    let yes = |is: bool| if is { "yes" } else { "no" }.to_owned();
    for set in sets.all() {
        for (name, closure) in CLOSURES {
            let [one, two] = [1.0, 2.0].map(|rho| set.bundled(closure, rho));
            let (one, two) = (Summary::of(&one?), Summary::of(&two?));
            let largest = two.sizes.iter().take(SHOWN);
            let largest: Vec<String> = largest
                .map(|(height, frames, _)| format!("{height}x{frames:.0}"))
                .collect();
            rows.add_row([
                set.name.to_owned(),
                name.to_owned(),
                one.n_bundles.to_string(),
                two.n_bundles.to_string(),
                one.n_submotions.to_string(),
                two.n_submotions.to_string(),
                format!("{:.1}", one.mean_frames),
                format!("{:.1}", two.mean_frames),
                percent(one.share),
                percent(two.share),
                yes(two.n_bundles < one.n_bundles),
                yes(two.mean_frames > one.mean_frames),
                largest.join(" "),
            ]);
        }
    }
    Ok(format!(
        "Bias: rho 2 prefers longer submotions. Frames are those of a submotion on average; largest are height x frames. \
         The paper's boxing at rho 2: {BOXING}\n{}\n\n",
        rows.trim_fmt()
    ))
}
