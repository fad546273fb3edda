//! identical
