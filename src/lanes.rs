//! The shape of the fleet's columns: vehicles live in blocks of [`LANES`] slots, one array per quantity.
//!
//! Loops over a block have a constant trip count, no branches and no aliasing between arrays, so that the compiler turns
//! them into vector code for whatever instruction set the machine has. Nothing in such a loop may call the platform's
//! maths library or fuse multiply-adds: both give other bits on other machines.

/// Slots of one block. A multiple of the widest vector (8 doubles).
pub const LANES: usize = 16;

/// One value per slot of a block.
pub type Lanes = [f64; LANES];

/// A flag per slot, 0.0 or 1.0, so that selecting by it stays in vector registers.
pub type Flags = [f64; LANES];
