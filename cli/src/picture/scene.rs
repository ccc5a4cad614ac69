//! Pictures of where hits are as scene descriptions ask.

use super::canvas::{Charted, Rgb};
use super::heatmap::Grid;

/// How a feature stands to a line of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// On, as the line asks.
    On,
    /// Off, as the line asks.
    Off,
    /// Not as the line asks.
    Otherwise,
    /// The line asks nothing here.
    Free,
}

impl State {
    /// In the order of their codes.
    pub const ALL: [State; 4] = [State::On, State::Off, State::Otherwise, State::Free];

    /// What it means.
    #[must_use]
    pub fn caption(self) -> &'static str {
        match self {
            State::On => "on, as asked",
            State::Off => "off, as asked",
            State::Otherwise => "not as asked",
            State::Free => "nothing asked",
        }
    }

    /// Blue agrees, orange does not, as where features are compared; all four differ in lightness.
    pub(super) fn colour(self) -> Rgb {
        match self {
            State::On => [0x14, 0x45, 0x80],
            State::Off => [0x7f, 0xa6, 0xcf],
            State::Otherwise => [0xd0, 0x55, 0x00],
            State::Free => [0xee, 0xf1, 0xf5],
        }
    }
}

/// A row per line of the scene, a column per word, `rate` of them a second.
#[must_use]
pub fn scene_chart(names: &[String], rows: &[Vec<State>], rate: f64) -> Charted {
    let grid = Grid {
        captions: names.to_vec(),
        n_columns: rows.first().map_or(0, Vec::len),
        rate,
    };
    grid.paint(|row, word| {
        let state = rows[row].get(word);
        state.map_or([u8::MAX; 3], |state| state.colour())
    })
}
