//! A run as data: its file, its changes, its options.

use crate::corpus::Seed;
use crate::mutation::{self, Mutation};
use crate::target::Target;
use anyhow::{Context, Result};
use fastrand::Rng;
use serde::{Deserialize, Serialize};

/// A reproducible run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// The reader, or a path that starts with one.
    pub target: Target,
    /// The name of the sound file.
    pub seed: String,
    /// The seed for the options of later steps.
    pub variant: u64,
    /// Its changes, in order.
    pub mutations: Vec<Mutation>,
}

/// The numbers that determine a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Number {
    /// Chosen by the caller; the same for all runs.
    pub seed: u64,
    /// The run's number.
    pub run: u64,
}

impl Case {
    /// Returns the case with a given number; deterministic for the same seeds.
    ///
    /// # Errors
    /// If no seed fits the target.
    pub fn of(target: Target, number: Number, seeds: &[Seed]) -> Result<Self> {
        let fitting: Vec<&Seed> = seeds.iter().filter(|seed| target.takes(seed)).collect();
        let mut rng = Rng::with_seed(mixed(mixed(number.seed ^ target as u64) ^ number.run));
        let seed = rng.choice(fitting).with_context(|| format!("no file for {}", target.name()))?;
        let variant = rng.u64(..1 << 32);
        Ok(Self {
            target,
            seed: seed.name.clone(),
            variant,
            mutations: mutation::choose(&mut rng, &seed.bytes),
        })
    }

    /// Returns the sound file.
    ///
    /// # Errors
    /// If it is not among `seeds`.
    pub fn sound<'a>(&self, seeds: &'a [Seed]) -> Result<&'a Seed> {
        let found = seeds.iter().find(|seed| seed.name == self.seed);
        found.with_context(|| format!("unknown seed {}; name its folder with --models", self.seed))
    }

    /// Returns the damaged file.
    ///
    /// # Errors
    /// As [`Self::sound`].
    pub fn bytes(&self, seeds: &[Seed]) -> Result<Vec<u8>> {
        Ok(mutation::changed(&self.sound(seeds)?.bytes, &self.mutations))
    }
}

/// Mixes the bits of a number (SplitMix64's finaliser), so that neighbouring numbers are uncorrelated.
fn mixed(number: u64) -> u64 {
    let number = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let number = (number ^ (number >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    number ^ (number >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::seeds;
    use clap::ValueEnum;
    use std::collections::HashSet;

    #[test]
    fn a_number_gives_one_case_and_numbers_give_many() {
        let seeds = seeds(None).unwrap();
        for target in Target::value_variants() {
            let case = |run| Case::of(*target, Number { seed: 1, run }, &seeds).unwrap();
            assert_eq!(case(7), case(7));
            let files: HashSet<Vec<u8>> = (0..50).map(|run| case(run).bytes(&seeds).unwrap()).collect();
            assert!(files.len() > 20, "{target:?}: {}", files.len());
        }
    }
}
