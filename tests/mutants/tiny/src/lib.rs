pub mod room;

#[cfg(test)]
mod tests {
    use crate::room::*;

    #[test]
    fn ages() {
        assert!(is_adult(18) && !is_adult(17));
        assert_eq!([price(3), price(70), price(30)], [0.0, 2.5, 5.0]);
    }

    #[test]
    fn sums() {
        let mut sum = Sum::ten();
        sum.add(2.0, 3.0);
        assert_eq!((sum.total, sum.count), (-6.0, 11));
        assert!(steps(3) == 3 && hidden::is_between(2, 1, 3) && !hidden::is_between(3, 1, 3));
    }
}
