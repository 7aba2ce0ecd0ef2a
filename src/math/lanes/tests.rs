//! Every width does what the plain numbers do.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::{DVec3, Vec3};

use super::*;

/// Random bits of SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ x >> 31
    }

    /// Number of moderate size.
    fn f64(&mut self) -> f64 {
        ((self.next() >> 11) as f64 * 2f64.powi(-52) - 1.0) * 2f64.powi((self.next() % 24) as i32 - 12)
    }
}

/// All pairs of special numbers, then pairs of random bits and of random numbers. Their count is a multiple of 16.
fn pairs<T: Copy>(specials: &[T], mut bits: impl FnMut(u64) -> T, mut number: impl FnMut(f64) -> T) -> [Vec<T>; 2] {
    let mut random = Random(1);
    let mut pairs: Vec<(T, T)> = specials.iter().flat_map(|&a| specials.iter().map(move |&b| (a, b))).collect();
    pairs.extend((0..2000).map(|_| (bits(random.next()), bits(random.next()))));
    pairs.extend((0..2000).map(|_| (number(random.f64()), number(random.f64()))));
    while !pairs.len().is_multiple_of(16) {
        pairs.push(pairs[0]);
    }
    let (a, b) = pairs.into_iter().unzip();
    [a, b]
}

fn pairs_f32() -> [Vec<f32>; 2] {
    let sizes = [0.0, f32::from_bits(1), 1e-40, f32::MIN_POSITIVE, f32::EPSILON, 1.0, 1.5, 3.0, 16_777_217.0, f32::MAX, f32::INFINITY];
    let mut specials: Vec<f32> = sizes.iter().flat_map(|&x| [x, -x]).collect();
    specials.push(f32::NAN);
    pairs(&specials, |bits| f32::from_bits(bits as u32), |x| x as f32)
}

fn pairs_f64() -> [Vec<f64>; 2] {
    let sizes = [
        0.0,
        f64::from_bits(1),
        1e-310,
        f64::MIN_POSITIVE,
        1e-45,
        7e-46,
        1e-40,
        f64::EPSILON,
        1.0,
        1.0 + 2f64.powi(-24),
        1.0 + 3.0 * 2f64.powi(-24),
        3.0,
        f32::MAX as f64,
        3.402_823_6e38,
        1e39,
        f64::MAX,
        f64::INFINITY,
    ];
    let mut specials: Vec<f64> = sizes.iter().flat_map(|&x| [x, -x]).collect();
    specials.push(f64::NAN);
    pairs(&specials, f64::from_bits, |x| x)
}

fn pairs_u32() -> [Vec<u32>; 2] {
    let specials = [0, 1, 2, 31, 255, 65_535, 65_536, 1 << 24 | 1, i32::MAX as u32, 1 << 31, u32::MAX - 1, u32::MAX];
    pairs(&specials, |bits| bits as u32, |x| x.abs() as u32)
}

fn pairs_u64() -> [Vec<u64>; 2] {
    let specials = [0, 1, 2, u32::MAX as u64, 1 << 32, 1 << 32 | 1, i64::MAX as u64, 1 << 63, u64::MAX - 1, u64::MAX];
    pairs(&specials, |bits| bits, |x| x.abs() as u64)
}

/// Equality bit for bit; all NaN are equal.
trait Same: Copy + std::fmt::Debug {
    fn same(self, other: Self) -> bool;
}

impl Same for f32 {
    fn same(self, other: f32) -> bool {
        self.to_bits() == other.to_bits() || self.is_nan() && other.is_nan()
    }
}

impl Same for f64 {
    fn same(self, other: f64) -> bool {
        self.to_bits() == other.to_bits() || self.is_nan() && other.is_nan()
    }
}

impl Same for u32 {
    fn same(self, other: u32) -> bool {
        self == other
    }
}

impl Same for u64 {
    fn same(self, other: u64) -> bool {
        self == other
    }
}

impl Same for bool {
    fn same(self, other: bool) -> bool {
        self == other
    }
}

/// Plain number of which a width has vectors.
trait Element<L: Lanes>: Same + Default {
    type Vector: Copy;
    fn load(from: &[Self]) -> Self::Vector;
    fn to_array(x: Self::Vector) -> [Self; 16];
}

macro_rules! element {
    ($number:ident, $vector:ident, $load:ident, $store:ident) => {
        impl<L: Lanes> Element<L> for $number {
            type Vector = L::$vector;

            #[inline(always)]
            fn load(from: &[$number]) -> L::$vector {
                L::$load(from)
            }

            #[inline(always)]
            fn to_array(x: L::$vector) -> [$number; 16] {
                let mut array = [Default::default(); 16];
                L::$store(x, &mut array);
                array
            }
        }
    };
}

element!(f32, F32, load, store);
element!(f64, F64, load_f64, store_f64);
element!(u32, U32, load_u32, store_u32);
element!(u64, U64, load_u64, store_u64);

impl<L: Lanes> Element<L> for bool {
    type Vector = L::Mask;

    #[inline(always)]
    fn load(from: &[bool]) -> L::Mask {
        L::mask((0..L::COUNT).map(|lane| (from[lane] as u32) << lane).sum())
    }

    #[inline(always)]
    fn to_array(x: L::Mask) -> [bool; 16] {
        let bits = L::bits(x);
        assert_eq!(bits as u64 >> L::COUNT, 0, "bits beyond the last lane");
        std::array::from_fn(|lane| bits >> lane & 1 == 1)
    }
}

/// Compares an operation on vectors with one on plain numbers, for all given pairs of operands.
#[inline(always)]
fn compare<L: Lanes, A: Element<L>, B: Element<L>>(
    name: &str,
    [a, b]: &[Vec<A>; 2],
    lanes: impl Fn(A::Vector, A::Vector) -> B::Vector,
    plain: impl Fn(A, A) -> B,
) {
    for (a, b) in a.chunks(L::COUNT).zip(b.chunks(L::COUNT)) {
        let results = B::to_array(lanes(A::load(a), A::load(b)));
        for lane in 0..L::COUNT {
            let expected = plain(a[lane], b[lane]);
            assert!(
                results[lane].same(expected),
                "{name} of {:?} and {:?} in lane {lane} of {}: {:?}, not {expected:?}",
                a[lane],
                b[lane],
                L::COUNT,
                results[lane]
            );
        }
    }
}

/// All operations on numbers and on masks.
struct Operations;

impl Kernel for Operations {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        single::<L>();
        double::<L>();
        whole::<L>();
        long::<L>();
        masks::<L>();
    }
}

#[inline(always)]
fn single<L: Lanes>() {
    let x = pairs_f32();
    compare::<L, f32, f32>("add", &x, |a, b| a + b, |a, b| a + b);
    compare::<L, f32, f32>("sub", &x, |a, b| a - b, |a, b| a - b);
    compare::<L, f32, f32>("mul", &x, |a, b| a * b, |a, b| a * b);
    compare::<L, f32, f32>("div", &x, |a, b| a / b, |a, b| a / b);
    compare::<L, f32, f32>("neg", &x, |a, _| -a, |a, _| -a);
    compare::<L, f32, f32>("a·b + b", &x, |a, b| a * b + b, |a, b| a * b + b);
    compare::<L, f32, f32>("sqrt", &x, |a, _| L::sqrt(a), |a, _| a.sqrt());
    compare::<L, f32, f32>("abs", &x, |a, _| L::abs(a), |a, _| a.abs());
    compare::<L, f32, f32>("min", &x, L::min, |a, b| if a < b { a } else { b });
    compare::<L, f32, f32>("max", &x, L::max, |a, b| if a > b { a } else { b });
    compare::<L, f32, f32>("copysign", &x, L::copysign, f32::copysign);
    compare::<L, f32, bool>("lt", &x, L::lt, |a, b| a < b);
    compare::<L, f32, bool>("le", &x, L::le, |a, b| a <= b);
    compare::<L, f32, f32>("select", &x, |a, b| L::select(L::le(a, L::f32(0.25)), a, b), |a, b| if a <= 0.25 { a } else { b });
    compare::<L, f32, f64>("widen", &x, |a, _| L::widen(a), |a, _| a as f64);
}

#[inline(always)]
fn double<L: Lanes>() {
    let x = pairs_f64();
    compare::<L, f64, f64>("add", &x, |a, b| a + b, |a, b| a + b);
    compare::<L, f64, f64>("sub", &x, |a, b| a - b, |a, b| a - b);
    compare::<L, f64, f64>("mul", &x, |a, b| a * b, |a, b| a * b);
    compare::<L, f64, f64>("div", &x, |a, b| a / b, |a, b| a / b);
    compare::<L, f64, f64>("neg", &x, |a, _| -a, |a, _| -a);
    compare::<L, f64, f64>("a·b + b", &x, |a, b| a * b + b, |a, b| a * b + b);
    compare::<L, f64, f32>("narrow", &x, |a, _| L::narrow(a), |a, _| a as f32);
    compare::<L, f64, f64>("sqrt_f64", &x, |a, _| L::sqrt_f64(a), |a, _| a.sqrt());
    compare::<L, f64, f64>("abs_f64", &x, |a, _| L::abs_f64(a), |a, _| a.abs());
    compare::<L, f64, f64>("min_f64", &x, L::min_f64, |a, b| if a < b { a } else { b });
    compare::<L, f64, f64>("max_f64", &x, L::max_f64, |a, b| if a > b { a } else { b });
    compare::<L, f64, bool>("lt_f64", &x, L::lt_f64, |a, b| a < b);
    compare::<L, f64, f64>("select_f64", &x, |a, b| L::select_f64(L::lt_f64(a, L::f64(0.25)), a, b), |a, b| if a < 0.25 { a } else { b });
}

#[inline(always)]
fn whole<L: Lanes>() {
    let x = pairs_u32();
    compare::<L, u32, u32>("add", &x, |a, b| a + b, u32::wrapping_add);
    compare::<L, u32, u32>("sub", &x, |a, b| a - b, u32::wrapping_sub);
    compare::<L, u32, u32>("mul", &x, |a, b| a * b, u32::wrapping_mul);
    compare::<L, u32, u32>("and", &x, |a, b| a & b, |a, b| a & b);
    compare::<L, u32, u32>("or", &x, |a, b| a | b, |a, b| a | b);
    compare::<L, u32, u32>("xor", &x, |a, b| a ^ b, |a, b| a ^ b);
    compare::<L, u32, bool>("eq_u32", &x, L::eq_u32, |a, b| a == b);
    compare::<L, u32, u32>(
        "select_u32",
        &x,
        |a, b| L::select_u32(L::eq_u32(a & L::u32(1), L::u32(1)), a, b),
        |a, b| if a & 1 == 1 { a } else { b },
    );
    compare::<L, u32, u32>("shl 0", &x, |a, _| L::shl::<0>(a), |a, _| a);
    compare::<L, u32, u32>("shl 7", &x, |a, _| L::shl::<7>(a), |a, _| a << 7);
    compare::<L, u32, u32>("shl 31", &x, |a, _| L::shl::<31>(a), |a, _| a << 31);
    compare::<L, u32, u32>("shr 0", &x, |a, _| L::shr::<0>(a), |a, _| a);
    compare::<L, u32, u32>("shr 9", &x, |a, _| L::shr::<9>(a), |a, _| a >> 9);
    compare::<L, u32, u32>("shr 31", &x, |a, _| L::shr::<31>(a), |a, _| a >> 31);
    compare::<L, u32, u64>("wide", &x, |a, _| L::wide(a), |a, _| a as u64);
    compare::<L, u32, u32>("reverse_bits", &x, |a, _| L::reverse_bits(a), |a, _| a.reverse_bits());
    compare::<L, u32, f32>("to_f32", &x, |a, _| L::to_f32(L::shr::<1>(a)), |a, _| (a >> 1) as f32);
    let x = pairs_f32().map(|numbers| numbers.into_iter().map(|x| if x.abs() < 2_147_483_648.0 { x.abs() } else { 7.5 }).collect());
    compare::<L, f32, u32>("to_u32", &x, |a, _| L::to_u32(a), |a, _| a as u32);
    let lanes: Vec<u32> = (0..16).collect();
    assert_eq!(to_array_u32::<L>(L::lanes())[..L::COUNT], lanes[..L::COUNT]);
}

#[inline(always)]
fn long<L: Lanes>() {
    let x = pairs_u64();
    compare::<L, u64, u64>("add", &x, |a, b| a + b, u64::wrapping_add);
    compare::<L, u64, u64>("mul", &x, |a, b| a * b, u64::wrapping_mul);
    compare::<L, u64, u64>("mul by a constant", &x, |a, _| a * L::u64(0x5851_f42d_4c95_7f2d), |a, _| a.wrapping_mul(0x5851_f42d_4c95_7f2d));
    compare::<L, u64, u64>("and", &x, |a, b| a & b, |a, b| a & b);
    compare::<L, u64, u64>("or", &x, |a, b| a | b, |a, b| a | b);
    compare::<L, u64, u64>("xor", &x, |a, b| a ^ b, |a, b| a ^ b);
    compare::<L, u64, u64>("shl_u64 0", &x, |a, _| L::shl_u64::<0>(a), |a, _| a);
    compare::<L, u64, u64>("shl_u64 17", &x, |a, _| L::shl_u64::<17>(a), |a, _| a << 17);
    compare::<L, u64, u64>("shl_u64 63", &x, |a, _| L::shl_u64::<63>(a), |a, _| a << 63);
    compare::<L, u64, u64>("shr_u64 0", &x, |a, _| L::shr_u64::<0>(a), |a, _| a);
    compare::<L, u64, u64>("shr_u64 17", &x, |a, _| L::shr_u64::<17>(a), |a, _| a >> 17);
    compare::<L, u64, u64>("shr_u64 63", &x, |a, _| L::shr_u64::<63>(a), |a, _| a >> 63);
    compare::<L, u64, f64>("from_bits_f64", &x, |a, _| L::from_bits_f64(a), |a, _| f64::from_bits(a));
    compare::<L, u64, u64>("bits_f64", &x, |a, _| L::bits_f64(L::from_bits_f64(a)), |a, _| a);
    compare::<L, u64, u64>("rotate_32", &x, |a, _| L::rotate_32(a), |a, _| a.rotate_left(32));
    compare::<L, u64, u32>("high", &x, |a, _| L::high(a), |a, _| (a >> 32) as u32);
    compare::<L, u64, u32>("low", &x, |a, _| L::low(a), |a, _| a as u32);
}

#[inline(always)]
fn masks<L: Lanes>() {
    let x = pairs(&[false, true], |bits| bits & 1 == 1, |x| x < 0.0);
    compare::<L, bool, bool>("mask and bits", &x, |a, _| a, |a, _| a);
    compare::<L, bool, bool>("and", &x, |a, b| a & b, |a, b| a & b);
    compare::<L, bool, bool>("or", &x, |a, b| a | b, |a, b| a | b);
    compare::<L, bool, bool>("xor", &x, |a, b| a ^ b, |a, b| a ^ b);
    compare::<L, bool, bool>("not", &x, |a, _| !a, |a, _| !a);
    for bits in [0, 1, 1 << (L::COUNT - 1), u32::MAX, u32::MAX << L::COUNT] {
        let inside = bits & ((1 << L::COUNT) - 1);
        assert_eq!(L::bits(L::mask(bits)), inside);
        assert_eq!(L::any(L::mask(bits)), inside != 0);
    }
}

#[test]
fn lanes_agree_with_plain_numbers() {
    for width in Width::available() {
        width.run(Operations);
    }
}

/// Gathers from tables of several lengths, also with indices beyond their ends.
struct Gathers;

impl Kernel for Gathers {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        for count in [1, 2, 7, 16, 1000] {
            let table: Vec<u32> = (0..count).map(|k| k * 3 + 1).collect();
            let table_f32: Vec<f32> = table.iter().map(|&x| x as f32).collect();
            let table_f64: Vec<f64> = table.iter().map(|&x| x.into()).collect();
            let expected = |index: u32| table[index.min(count - 1) as usize];
            compare::<L, u32, u32>("gather_u32", &pairs_u32(), |a, _| L::gather_u32(&table, a), |a, _| expected(a));
            compare::<L, u32, f32>("gather", &pairs_u32(), |a, _| L::gather(&table_f32, a), |a, _| expected(a) as f32);
            compare::<L, u32, f64>("gather_f64", &pairs_u32(), |a, _| L::gather_f64(&table_f64, a), |a, _| expected(a).into());
        }
    }
}

#[test]
fn gather_is_bounded() {
    for width in Width::available() {
        width.run(Gathers);
    }
}

/// Loads and stores of slices that are one too short, and gathers from empty tables.
struct Short;

impl Kernel for Short {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let count = L::COUNT - 1;
        let refused = |f: &mut dyn FnMut()| assert!(catch_unwind(AssertUnwindSafe(f)).is_err());
        refused(&mut || _ = L::load(&[0.0; 16][..count]));
        refused(&mut || _ = L::load_f64(&[0.0; 16][..count]));
        refused(&mut || _ = L::load_u32(&[0; 16][..count]));
        refused(&mut || _ = L::load_u64(&[0; 16][..count]));
        refused(&mut || L::store(L::f32(0.0), &mut [0.0; 16][..count]));
        refused(&mut || L::store_f64(L::f64(0.0), &mut [0.0; 16][..count]));
        refused(&mut || L::store_u32(L::u32(0), &mut [0; 16][..count]));
        refused(&mut || L::store_u64(L::u64(0), &mut [0; 16][..count]));
        refused(&mut || _ = L::gather(&[], L::u32(0)));
        refused(&mut || _ = L::gather_u32(&[], L::u32(0)));
        refused(&mut || _ = L::gather_f64(&[], L::u32(0)));
        refused(&mut || _ = get::<L>(L::f32(0.0), L::COUNT));
    }
}

#[test]
fn short_slices_are_refused() {
    for width in Width::available() {
        width.run(Short);
    }
}

/// All operations on vectors of three numbers.
struct Vectors;

impl Kernel for Vectors {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let mut random = Random(2);
        for _ in 0..500 {
            let mut plain =
                || -> [Vec3; 16] { std::array::from_fn(|_| Vec3::new(random.f64() as f32, random.f64() as f32, random.f64() as f32)) };
            let (a, b, c) = (plain(), plain(), plain());
            let vector = |v: &[Vec3; 16]| Vector::<L>::load(&v.map(|v| v.x), &v.map(|v| v.y), &v.map(|v| v.z));
            let (va, vb, by) = (vector(&a), vector(&b), vector(&c).x);
            let below = L::lt(va.x, vb.x);
            let [add, mul] = [va + vb, va * vb];
            let mut changed = va;
            for lane in 0..L::COUNT {
                let (a, b, c) = (a[lane], b[lane], c[lane].x);
                assert_eq!(va.get(lane), a);
                assert_eq!(add.get(lane), a + b);
                assert_eq!((va - vb).get(lane), a - b);
                assert_eq!((-va).get(lane), -a);
                assert_eq!(mul.get(lane), a * b);
                assert_eq!(va.scaled(by).get(lane), a * c);
                assert_eq!(va.divided(by).get(lane), a / c);
                assert_eq!(get::<L>(va.dot(vb), lane), a.dot(b));
                assert_eq!(va.cross(vb).get(lane), a.cross(b));
                assert_eq!(get::<L>(va.length_squared(), lane), a.length_squared());
                assert_eq!(get::<L>(va.length(), lane), a.length());
                assert_eq!(Vector::select(below, va, vb).get(lane), if a.x < b.x { a } else { b });
                assert_eq!(Vector::<L>::splat(a).get(lane), a);

                let (wa, wb, da, db) = (va.widened(), vb.widened(), a.as_dvec3(), b.as_dvec3());
                let number = |x: L::F64| <f64 as Element<L>>::to_array(x)[lane];
                let double = |v: VectorF64<L>| DVec3::new(number(v.x), number(v.y), number(v.z));
                assert_eq!(double(wa), da);
                assert_eq!(double(wa + wb), da + db);
                assert_eq!(double(wa - wb), da - db);
                assert_eq!(number(wa.dot(wb)), da.dot(db));
                assert_eq!(double(wa.cross(wb)), da.cross(db));
                // Components with more digits than those of a product of single precision.
                assert_eq!(number(wa.cross(wb).length_squared()), da.cross(db).length_squared());

                changed.set(lane, b);
                for other in 0..L::COUNT {
                    assert_eq!(changed.get(other), if other <= lane { vb.get(other) } else { va.get(other) });
                }
            }
            assert_eq!(to_array::<L>(va.x)[L::COUNT..], [0.0; 16][L::COUNT..]);
            assert_eq!(to_array_u32::<L>(L::u32(7))[L::COUNT..], [0; 16][L::COUNT..]);
        }
    }
}

#[test]
fn vectors_agree_with_glam() {
    for width in Width::available() {
        width.run(Vectors);
    }
}

#[test]
fn widths_are_in_order() {
    let widths = Width::available();
    assert_eq!(widths[0].count(), 1);
    assert!(widths.is_sorted_by_key(|width| width.count()));
    assert!(widths.contains(&Width::detect()));
}
