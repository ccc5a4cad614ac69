//! Figures of the authors' Table 2.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};

/// A row of Table 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) folder: String,
    /// Relevant clips in the evaluation database.
    pub(crate) n_relevant: usize,
    /// Template length K.
    pub(crate) n_columns: usize,
    /// |H| at the six thresholds, over the evaluation clips of all 64 classes.
    pub(crate) hits: [usize; 6],
    /// |H⁺| at the six thresholds.
    pub(crate) relevant_hits: [usize; 6],
}

/// The rows there are.
#[derive(Clone, Debug)]
pub(crate) struct Published(Vec<Row>);

/// |H| of `Squat` in the paper's Table 2; the authors' extended table with |H⁺| ends before it.
const SQUAT_HITS: [usize; 6] = [23, 24, 26, 26, 26, 27];

impl Published {
    /// Reads `labels/mce-table-part1.tsv` and adds the printed row of squats, where |H| up to the
    /// number of relevant clips stands in for |H⁺|.
    pub(crate) fn read(data: &Path) -> Result<Published> {
        let path = data.join("labels/mce-table-part1.tsv");
        let text = fs::read_to_string(&path);
        let text = text.with_context(|| format!("cannot read {}", path.display()))?;
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        let rows = lines.map(|line| row(line).with_context(|| format!("bad row: {line}")));
        let mut rows: Vec<Row> = rows.collect::<Result<_>>()?;
        let n_relevant = 26;
        rows.push(Row {
            folder: "squat1Reps".to_owned(),
            n_relevant,
            n_columns: 48,
            hits: SQUAT_HITS,
            relevant_hits: SQUAT_HITS.map(|n| n.min(n_relevant)),
        });
        Ok(Published(rows))
    }

    pub(crate) fn of(&self, folder: &str) -> Option<&Row> {
        self.0.iter().find(|row| row.folder == folder)
    }
}

fn row(line: &str) -> Result<Row> {
    let cells: Vec<&str> = line.split('\t').collect();
    ensure!(cells.len() == 7, "expected 7 cells, found {}", cells.len());
    Ok(Row {
        folder: cells[1].to_owned(),
        n_relevant: cells[2].parse()?,
        n_columns: cells[3].parse()?,
        hits: six(cells[5])?,
        relevant_hits: six(cells[6])?,
    })
}

fn six(cell: &str) -> Result<[usize; 6]> {
    let numbers: Result<Vec<usize>, _> = cell.split('/').map(str::parse).collect();
    let numbers = numbers?.try_into();
    numbers.map_err(|_| anyhow::anyhow!("expected six numbers, found {cell}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read() {
        let line = "HopLLeg\thopLLeg1hops\t20\t19\t3.83\t15/19/23/51/96/174\t15/19/20/20/20/20";
        let row = row(line).unwrap();
        assert_eq!(
            (row.folder.as_str(), row.n_relevant, row.n_columns),
            ("hopLLeg1hops", 20, 19)
        );
        assert_eq!(row.hits, [15, 19, 23, 51, 96, 174]);
        assert_eq!(row.relevant_hits, [15, 19, 20, 20, 20, 20]);
        assert!(six("1/2").is_err());
    }
}
