pub fn is_between(x: i32, low: i32, high: i32) -> bool {
    low < x && x < high
}
