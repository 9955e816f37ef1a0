//! `study stress`: what becomes of bodies under what is likely to break them.

use super::{Findings, Plan, StudyOptions};
use crate::cli::failure::{Failure, Status};
use crate::cli::options::ThreadOptions;
use crate::cli::record;
use crate::study::stress::{Protocol, measure};
use clap::Args;

/// Falls, impacts, degenerate starts and elements, very long runs: what becomes of each with every model
#[derive(Args, Debug)]
pub(super) struct Stress {
    #[command(flatten)]
    threads: ThreadOptions,
    #[command(flatten)]
    options: StudyOptions,
}

impl Stress {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let mark = "localshape study stress".to_owned();
        let plan = Plan { name: "stress", mark: mark.clone(), plots: &[], work: Protocol::FULL.work() };
        let pool = record::pool(self.threads.count())?;
        self.options.run(&plan, None, |watch| {
            let results = pool.install(|| measure(Protocol::FULL, watch))?;
            Some(Findings {
                markdown: results.markdown(&mark),
                csv: results.csv(),
                #[cfg(feature = "render")]
                plots: Vec::new(),
                json: results.json(),
            })
        })
    }
}
