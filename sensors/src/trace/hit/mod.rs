//! Properties of a hit: its instance and triangle, its point, its distance and its normal.

pub(crate) mod cache;
pub(crate) mod curved;
pub(crate) mod measure;
pub(crate) mod normals;
pub(crate) mod point;
pub(crate) mod resolve;
