//! Records as Markdown tables for the README.
//!
//! Every engine that ran has a row in every table, whoever wins.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::definition::{Mode, RaySet};
use crate::record::{BuildRecord, Comparison, Measured, Record, SceneRecord, Size, TraceRecord};

/// The seconds that tables of engines are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clock {
    Wall,
    /// CPU seconds; for rays, shared out among the threads.
    Cpu,
}

impl Clock {
    fn seconds(self, build: &BuildRecord) -> f64 {
        match self {
            Clock::Wall => build.seconds.best,
            Clock::Cpu => build.cpu_seconds,
        }
    }

    fn mrays(self, trace: &TraceRecord) -> f64 {
        match self {
            Clock::Wall => trace.mrays.best,
            Clock::Cpu => trace.cpu_mrays.best,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Clock::Wall => "wall",
            Clock::Cpu => "CPU",
        }
    }
}

/// The tables of a record, with a line on where it was made.
pub(crate) fn markdown(record: &Record, clock: Clock) -> String {
    let Record { date, machine, .. } = record;
    let named = record.versions.iter().map(|(name, version)| format!("{name} {version}"));
    let versions = named.collect::<Vec<_>>().join(", ");
    let (cores, simd) = (machine.cores, machine.simd.join(" "));
    let mut text = format!("{date}, {} ({cores} cores, {simd}); {versions}.\n", machine.cpu);
    match &record.measured {
        Measured::Engines(comparison) => engines(&mut text, comparison, clock),
        Measured::Scaling(sizes) => scaling(&mut text, sizes),
    }
    text
}

/// The head of the table of [`size_row`].
pub(crate) const SIZE_HEAD: &str = "| triangles | threads | best s | median s | \u{b5}s a triangle | peak MB |\n|--:|--:|--:|--:|--:|--:|\n";

/// A build at one size.
pub(crate) fn size_row(size: &Size) -> String {
    format!(
        "| {} | {} | {} | {} | {} | {} |\n",
        grouped(size.triangles),
        size.threads,
        number(size.seconds.best),
        number(size.seconds.median),
        number(1e6 * size.seconds.best / size.triangles as f64),
        number(megabytes(size.memory.peak_bytes)),
    )
}

fn scaling(text: &mut String, sizes: &[Size]) {
    text.push('\n');
    text.push_str(SIZE_HEAD);
    for size in sizes {
        text.push_str(&size_row(size));
    }
}

fn engines(text: &mut String, comparison: &Comparison, clock: Clock) {
    let baseline = &comparison.baseline;
    let _ = writeln!(
        text,
        "\nBuild: best {clock} seconds. MB: the finished index, and the most during the build. \
         Rays: best pass, millions per {clock}\nsecond. In brackets the ratio to {baseline}, one \
         ray at a time: below 1 is better for seconds and MB, above 1 for rays.\nDiffer: the \
         largest share of a ray set on which the hits are not {baseline}'s.",
        clock = clock.word(),
    );
    for missing in &comparison.missing {
        let _ = writeln!(text, "\nLeft out: {missing}.");
    }
    for scene in &comparison.scenes {
        let threads: BTreeSet<_> = scene.builds.iter().map(|build| build.threads).collect();
        for threads in threads {
            let table = Table { scene, baseline, threads, clock };
            table.write(text);
        }
    }
}

/// One scene on one number of threads.
struct Table<'a> {
    scene: &'a SceneRecord,
    baseline: &'a str,
    threads: usize,
    clock: Clock,
}

impl Table<'_> {
    fn write(&self, text: &mut String) {
        let (scene, threads) = (self.scene, self.threads);
        let plural = if threads == 1 { "" } else { "s" };
        let count = grouped(scene.triangles);
        let _ =
            writeln!(text, "\n**{}**, {count} triangles, {threads} thread{plural}\n", scene.name);
        text.push_str("| engine | build s | MB | peak MB |");
        for set in &scene.sets {
            let _ = write!(text, " {} |", set.set.name());
        }
        let rule = "--:|".repeat(scene.sets.len());
        let _ = writeln!(text, " differ |\n|---|--:|--:|--:|{rule}--:|");
        for build in self.builds() {
            for mode in self.modes(&build.engine) {
                self.row(text, build, mode);
            }
        }
    }

    fn builds(&self) -> impl Iterator<Item = &BuildRecord> {
        self.scene.builds.iter().filter(|build| build.threads == self.threads)
    }

    /// The modes of an engine in the order they were traced.
    fn modes(&self, engine: &str) -> Vec<Mode> {
        let mut modes = Vec::new();
        for trace in self.scene.traces.iter().filter(|trace| trace.engine == engine) {
            if !modes.contains(&trace.mode) {
                modes.push(trace.mode);
            }
        }
        modes
    }

    /// Modes after the first share the build, so only the first row repeats it.
    fn row(&self, text: &mut String, build: &BuildRecord, mode: Mode) {
        let _ = write!(text, "| {}{} |", build.engine, suffix(mode));
        let base = self.builds().find(|base| base.engine == self.baseline);
        let figures: [fn(Clock, &BuildRecord) -> f64; 3] = [
            Clock::seconds,
            |_, build| megabytes(build.final_bytes),
            |_, build| megabytes(build.peak_bytes),
        ];
        let first = self.modes(&build.engine).first() == Some(&mode);
        for figure in figures {
            match first {
                true => cell(text, figure(self.clock, build), base.map(|b| figure(self.clock, b))),
                false => text.push_str("  |"),
            }
        }
        self.rates(text, &build.engine, mode);
    }

    fn rates(&self, text: &mut String, engine: &str, mode: Mode) {
        let mut differ: Vec<f64> = Vec::new();
        for set in &self.scene.sets {
            match self.trace(engine, mode, set.set) {
                Some(trace) => {
                    let base = self.trace(self.baseline, Mode::Single, set.set);
                    let rate = self.clock.mrays(trace);
                    cell(text, rate, base.map(|base| self.clock.mrays(base)));
                    differ.extend(trace.differ);
                }
                None => text.push_str(" - |"),
            }
        }
        let worst = differ.into_iter().max_by(f64::total_cmp);
        let _ = writeln!(text, " {} |", worst.map_or("-".to_owned(), share));
    }

    fn trace(&self, engine: &str, mode: Mode, set: RaySet) -> Option<&TraceRecord> {
        let wanted = (engine, mode, set, self.threads);
        let is_it = |t: &&TraceRecord| (t.engine.as_str(), t.mode, t.set, t.threads) == wanted;
        self.scene.traces.iter().find(is_it)
    }
}

fn suffix(mode: Mode) -> &'static str {
    match mode {
        Mode::Single => "",
        Mode::Packet8 => ", packets of 8",
        Mode::Packet16 => ", packets of 16",
        Mode::Batch => ", batches",
    }
}

fn cell(text: &mut String, value: f64, base: Option<f64>) {
    let ratio = base.map_or(String::new(), |base| format!(" ({:.2})", value / base));
    let _ = write!(text, " {}{ratio} |", number(value));
}

/// A share of rays, which may be one in a million.
fn share(share: f64) -> String {
    if share == 0.0 { "0".to_owned() } else { format!("{share:.1e}") }
}

/// Three significant digits.
fn number(value: f64) -> String {
    let digits = (2.0 - value.abs().max(1e-6).log10().floor()).clamp(0.0, 6.0);
    format!("{value:.*}", digits as usize)
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

/// Thousands apart, as in 69,451.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn golden(clock: Clock) -> String {
        let record = include_str!("../tests/record.json");
        markdown(&serde_json::from_str(record).expect("a record"), clock)
    }

    #[test]
    fn the_table_is_the_golden_one() {
        assert_eq!(golden(Clock::Wall), include_str!("../tests/record.md"));
    }

    #[test]
    fn the_cpu_table_takes_the_other_clock() {
        let text = golden(Clock::Cpu);
        assert!(text.contains("best CPU seconds"));
        let row = "| kdray | 0.290 (1.53) | 3.00 (0.50) | 36.0 (4.00) | 9.50 (0.50) |";
        assert!(text.contains(row), "{text}");
    }

    #[test]
    fn numbers_have_three_digits() {
        let cases = [
            (0.0301, "0.0301"),
            (17.62, "17.6"),
            (417.4, "417"),
            (1234.0, "1234"),
            (9.999, "10.00"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
        assert_eq!(number(0.0), "0.000000");
    }

    #[test]
    fn counts_are_grouped() {
        assert_eq!(
            [1, 999, 1000, 69_451, 1_087_428].map(grouped),
            ["1", "999", "1,000", "69,451", "1,087,428"]
        );
    }
}
