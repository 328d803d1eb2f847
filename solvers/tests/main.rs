//! Methods against each other, on random problems and on the frozen ones.
#![allow(clippy::unwrap_used)]

mod acceleration;
mod active_set;
mod agreement;
mod column;
mod decomposition;
mod elasticity;
mod equation_map;
mod equivalences;
mod existence;
mod first_order;
mod friction;
mod friction_convex;
mod friction_latin;
mod friction_truth;
mod fuzz;
mod hard;
mod hazards;
mod infeasible;
mod layouts;
mod measured;
mod newton_schur;
mod newton_spheres;
mod precision;
mod predictions;
mod problem_and_measures;
mod problems;
mod product;
mod proportioning;
mod reference;
mod rough_spheres;
mod spheres;
