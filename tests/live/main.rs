//! The program against real SUMO, the newest and the oldest supported version. A missing SUMO is a failure, not a skip.

mod city;
mod clients;
#[cfg(target_os = "linux")]
mod cores;
mod coupling;
mod determinism;
mod faults;
mod foreign;
mod friction;
mod grade;
mod hostile;
mod identical;
mod lifecycle;
mod names;
mod orders;
mod outputs;
mod platoon;
mod quality;
mod session;
mod settings;
mod spacing;
mod step;
mod strange;
mod support;
mod trace;
mod tyres;
mod window;
