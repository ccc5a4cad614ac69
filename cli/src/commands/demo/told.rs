//! The tour as it is told.

use std::io::{self, Write};

use super::corpus::Corpus;
use super::{DemoResult, DemoSearch, STOPS, Stop};
use crate::corpus::Class;
use crate::output::{count, table};

/// Hits shown per search.
const SHOWN: usize = 6;

impl Corpus {
    pub(super) fn tell(&self, out: &mut dyn Write, result: &DemoResult) -> io::Result<()> {
        let n_takes = self.files.iter().filter(|f| f.class.is_none()).count();
        writeln!(
            out,
            "Five procedural performers, {} kinds of motion: {} and {} in {}",
            Class::ALL.len(),
            count(self.files.len() - n_takes, "single clip"),
            count(n_takes, "long take"),
            self.dir.display()
        )?;
        let (index, total) = (&result.index, &result.index.total);
        writeln!(
            out,
            "{} frames read, {} segments indexed in {:.1} s: {}",
            index.frames, total.segments, index.seconds.total, index.library
        )?;
        for (stop, one) in STOPS.iter().zip(&result.searches) {
            self.tell_search(out, stop, one)?;
        }
        result.annotation.tell(out)?;
        result.alignment.tell(out)?;
        writeln!(out, "\npictures: {}", result.pictures.join(", "))?;
        self.tell_next(out, result)?;
        result.report.tell(out)
    }

    fn tell_search(&self, out: &mut dyn Write, stop: &Stop, one: &DemoSearch) -> io::Result<()> {
        let search = &one.search;
        writeln!(
            out,
            "\nLike {}: {}",
            self.short(&search.query.clip),
            stop.question
        )?;
        writeln!(
            out,
            "  features {}; {} of {} performances of {} found, {}",
            search.query.features.join(", "),
            one.found,
            one.performances,
            one.class,
            match one.wrong {
                0 => "no other motion".to_owned(),
                n => count(n, "other hit"),
            }
        )?;
        let mut rows = table(&["rank", "cost", "clip", "frames", "seconds", "shows"]);
        for hit in search.hits.iter().take(SHOWN) {
            rows.add_row([
                hit.rank.to_string(),
                hit.cost.to_string(),
                self.short(&hit.clip),
                format!("{}-{}", hit.start, hit.end),
                format!("{:.2}-{:.2}", hit.start_s, hit.end_s),
                self.shows(hit).to_owned(),
            ]);
        }
        for line in rows.trim_fmt().lines() {
            writeln!(out, "  {line}")?;
        }
        Ok(())
    }

    fn tell_next(&self, out: &mut dyn Write, result: &DemoResult) -> io::Result<()> {
        let program = std::env::args()
            .next()
            .unwrap_or_else(|| "motif".to_owned());
        let clip = |class: Class| {
            let file = self.files.iter().rev().find(|f| f.class == Some(class));
            file.map_or(String::new(), |f| f.path.display().to_string())
        };
        writeln!(out, "\nTry next:")?;
        let library = &result.index.library;
        for line in [
            format!(
                "search {library} --example {} --features F3 F7",
                clip(Class::Wave)
            ),
            format!(
                "search {library} --example {} --features F2 lelbow_bent",
                clip(Class::PunchLeft)
            ),
            format!(
                "search {library} --example {} --features F15 F16 --top 50",
                clip(Class::Walk)
            ),
            format!(
                "search {library} --scene \"rfoot_raised: 0 1 0; lelbow_bent: 1 0 1; \
                 before rfoot_raised[2] lelbow_bent[2]; within 4s\""
            ),
            format!(
                "search {library} --template {}/hop.mtpl --keyframes auto",
                result.annotation.templates
            ),
            format!(
                "template show {}/kick_left.mtpl",
                result.annotation.templates
            ),
            format!(
                "annotate {} --templates {} -o spans.csv",
                self.dir.display(),
                result.annotation.templates
            ),
            format!("features {} -o hop.png", clip(Class::Hop)),
            format!("info {}", clip(Class::Jog)),
            format!(
                "align {} {} -o path.csv",
                result.alignment.a, result.alignment.b
            ),
            "index FOLDER -o my.lib      (your own BVH, AMC and C3D files)".to_owned(),
        ] {
            writeln!(out, "  {program} {line}")?;
        }
        Ok(())
    }
}
