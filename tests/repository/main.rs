//! Tests of the repository itself: its layers, its pages, the data of its benchmarks.

mod benchmark_copies;
mod benchmark_history;
mod benchmark_scenes;
mod benchmark_verdict;
mod docs;
mod layers;
mod models;
mod package;
mod page_layout;
mod point_tables;
