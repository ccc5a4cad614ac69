//! Which clips the contact sheet shows, and in which order.

use std::cmp::Ordering;

use serde::Deserialize;

use super::View;
use super::answer::Refusal;
use super::clips::Row;
use super::fragment::Listing;
use super::routes::Question;

/// Most clips of an answer.
const MOST: usize = 200;

/// Clips of an answer unless asked otherwise.
const USUAL: usize = 40;

/// `/api/clips`.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Asked {
    /// Clips to leave out at the beginning.
    from: usize,
    n: Option<usize>,
    sort: Sort,
    /// 1 for the last first.
    down: u8,
    /// Only clips of this label.
    label: Option<String>,
    /// Only clips whose names have this, in any case.
    text: Option<String>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Sort {
    #[default]
    Name,
    Label,
    Seconds,
}

impl Question for Asked {
    type Answer = Listing;

    fn answer(&self, view: &View) -> Result<Listing, Refusal> {
        let n = self.n.unwrap_or(USUAL);
        if n > MOST {
            return Err(Refusal::question(format!(
                "n: expected up to {MOST}, found {n}"
            )));
        }
        let ids = self.ids(view.clips.rows());
        let wanted = ids.iter().copied().skip(self.from).take(n);
        let wanted: Vec<u32> = wanted.collect();
        Listing::new(view, ids.len(), &wanted)
    }
}

impl Asked {
    /// The numbers of all clips that are asked for, in order; equals in the order of the library.
    fn ids(&self, rows: &[Row]) -> Vec<u32> {
        let label = self.label.as_deref().filter(|label| !label.is_empty());
        let text = self.text.as_deref().unwrap_or_default().to_lowercase();
        let is_asked = |row: &Row| {
            let is_labelled = label.is_none_or(|label| row.label.as_deref() == Some(label));
            is_labelled && row.clip.name.to_lowercase().contains(&text)
        };
        let asked = (0..).zip(rows).filter(|(_, row)| is_asked(row));
        let mut asked: Vec<(u32, &Row)> = asked.collect();
        let order = |a: &Row, b: &Row| -> Ordering {
            let by_name = || a.clip.name.cmp(&b.clip.name);
            match self.sort {
                Sort::Name => by_name(),
                Sort::Label => a.label.cmp(&b.label).then_with(by_name),
                Sort::Seconds => a.seconds.total_cmp(&b.seconds).then_with(by_name),
            }
        };
        asked.sort_by(|(_, a), (_, b)| match self.down {
            0 => order(a, b),
            _ => order(b, a),
        });
        asked.into_iter().map(|(id, _)| id).collect()
    }
}
