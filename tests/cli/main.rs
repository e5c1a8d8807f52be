//! The program as its users run it: commands, messages, files, ranks.

mod bad_input;
mod browser;
mod command_line;
mod deck;
mod explore;
mod explore_fields;
mod explore_map;
mod explore_page;
mod explore_paths;
mod explore_resume;
mod explore_shapes;
mod external_matrices;
mod joints;
mod json;
mod matrix_formats;
mod memory;
mod no_convergence;
mod parallel;
mod reduced_brake;
mod results_file;
mod resume;
mod states;
mod strange_input;
mod study;
#[path = "../support/mod.rs"]
mod support;
mod units;
mod wear;
