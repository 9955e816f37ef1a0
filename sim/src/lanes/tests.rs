use super::*;

/// Every operation on three vectors: its results, lane after lane.
struct Everything([[f64; MOST]; 3]);

impl Work for Everything {
    type Output = Vec<Vec<f64>>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<Vec<f64>> {
        // Eight lanes of each operation, in as many vectors as the width needs.
        let mut all = vec![Vec::new(); 19];
        let mut previous = L::splat(9.0);
        for first in (0..MOST).step_by(L::WIDTH) {
            // SAFETY: WIDTH divides MOST.
            let [a, b, c] = self.0.each_ref().map(|array| unsafe { L::load(array[first..].as_ptr()) });
            let next = self.0[0].get(first + L::WIDTH).map_or(9.0, |&value| value);
            let flag = |mask| {
                assert_eq!(L::bits(L::mask(L::bits(mask))), L::bits(mask));
                L::splat(1.0).select(mask, L::splat(0.0))
            };
            let results = [
                a + b,
                a - b,
                a * b,
                -a,
                a.mul_add(b, c),
                a.neg_mul_add(b, c),
                a.mul_sub(b, c),
                a.div(b),
                a.abs().sqrt(),
                a.max(b),
                a.abs(),
                flag(a.lt(b)),
                flag(a.le(b)),
                c.select(a.lt(b), a),
                a.shift_in(previous),
                a.shift_out(L::splat(next)),
                flag(L::both(a.lt(b), b.le(c))),
                flag(L::mask(0b0110_1001 >> first)),
                L::from_array(a.to_array()),
            ];
            previous = a;
            for (out, result) in all.iter_mut().zip(results) {
                out.extend_from_slice(&result.to_array()[..L::WIDTH]);
            }
        }
        all
    }
}

#[test]
fn every_set_does_what_one_lane_after_the_other_would() {
    let a = [1.0, -0.1, 3e200, 5.0, 0.0, f64::NAN, 7.0 / 3.0, -1e-300];
    let b = [1.0 / 3.0, 0.3, -2e150, 5.0, -0.0, 1.0, 0.7, 1e-20];
    let c = [-1.0 / 3.0, 0.03, 1.0, f64::INFINITY, 4.0, 2.0, f64::NAN, 3.0];
    let each =
        |one: &dyn Fn(f64, f64, f64) -> f64| -> Vec<f64> { (0..MOST).map(|at| one(a[at], b[at], c[at])).collect() };
    let flag = f64::from;
    let expected = [
        each(&|a, b, _| a + b),
        each(&|a, b, _| a - b),
        each(&|a, b, _| a * b),
        each(&|a, _, _| -a),
        each(&|a, b, c| a.mul_add(b, c)),
        each(&|a, b, c| (-a).mul_add(b, c)),
        each(&|a, b, c| a.mul_add(b, -c)),
        each(&|a, b, _| a / b),
        each(&|a, _, _| a.abs().sqrt()),
        each(&|a, b, _| if a > b { a } else { b }),
        each(&|a, _, _| a.abs()),
        each(&|a, b, _| flag(a < b)),
        each(&|a, b, _| flag(a <= b)),
        each(&|a, b, c| if a < b { c } else { a }),
        [9.0].into_iter().chain(a).take(MOST).collect(),
        a.into_iter().skip(1).chain([9.0]).collect(),
        each(&|a, b, c| flag(a < b && b <= c)),
        [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0].to_vec(),
        a.to_vec(),
    ];
    // The bits of NaN are not defined.
    let bits = |all: &[Vec<f64>]| -> Vec<Vec<u64>> {
        all.iter().map(|one| one.iter().map(|v| if v.is_nan() { u64::MAX } else { v.to_bits() }).collect()).collect()
    };
    for set in Set::all() {
        assert_eq!(bits(&set.run(Everything([a, b, c]))), bits(&expected), "{set:?}");
    }
    assert!(Set::all().any(|set| set == Set::best()));
}
