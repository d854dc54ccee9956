//! The largest step that holds a scallop.

/// A step this much of the target or more is as good as the largest: a pass in fifty at the most.
const NEAR: f64 = 0.97;

/// What is aimed at, as a share of the target: a bit below it, so that the next try holds.
const AIM: f64 = 0.99;

/// Tries at the most. From a good guess it takes two or three.
const TRIES: usize = 10;

/// The largest of a scallop that is taken for what it would be if steps grew: beyond, guesses are halved.
const GROWS: f64 = 2.0;

/// A step that was tried.
pub(super) struct Tried<T> {
    pub(super) step_mm: f64,
    pub(super) found: T,
}

/// Looks between `least` and `most` for the largest step at which `scallop` is at most `target`. The scallop
/// grows as the square of the step on smooth surfaces; that gives the next guess, and halving what is not
/// decided where it leads astray. If no step holds, the least is returned.
///
/// # Errors
/// Those of `scallop`.
pub(super) fn largest_step<T, E>(
    [least, most]: [f64; 2],
    guess: f64,
    target: f64,
    scallop: impl Fn(f64) -> Result<(f64, T), E>,
) -> Result<Tried<T>, E> {
    let mut holds: Option<Tried<T>> = None;
    let mut too_far: Option<f64> = None;
    let mut step = guess.clamp(least, most);
    for tries in 0..TRIES {
        let (scallop_mm, found) = scallop(step)?;
        let held = scallop_mm <= target;
        let guess = step * (AIM * target / scallop_mm.max(target / 16.0)).sqrt();
        if !held && step <= least {
            return Ok(Tried { step_mm: step, found });
        }
        if held {
            let done = step >= most || scallop_mm >= NEAR * target;
            holds = Some(Tried { step_mm: step, found });
            if done {
                break;
            }
        } else {
            too_far = Some(step);
        }
        let low = holds.as_ref().map_or(least, |held| held.step_mm);
        let high = too_far.unwrap_or(most);
        // What is left to be gained is a hundredth of a step.
        if holds.is_some() && high < low * 1.01 {
            break;
        }
        let middle = (low * high).sqrt();
        let astray = guess <= low || guess >= high && too_far.is_some() || tries >= TRIES / 2;
        step = if tries + 2 == TRIES && holds.is_none() {
            least
        } else if astray && (holds.is_some() || tries > 1) {
            middle
        } else {
            guess.clamp(low / GROWS, high).clamp(least, most)
        };
    }
    match holds {
        Some(held) => Ok(held),
        None => {
            let (_, found) = scallop(least)?;
            Ok(Tried { step_mm: least, found })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    fn found(guess: f64, scallop: impl Fn(f64) -> f64) -> (f64, usize) {
        let count = Cell::new(0);
        let tried = largest_step([0.01, 10.0], guess, 0.08, |step| {
            count.set(count.get() + 1);
            Ok::<_, ()>((scallop(step), ()))
        });
        (tried.unwrap().step_mm, count.get())
    }

    #[test]
    fn a_scallop_that_grows_with_the_square_takes_two_or_three_tries() {
        let (largest, off) = ((24.0 * 0.08_f64).sqrt(), 0.02);
        for guess in [0.7 * largest, 0.95 * largest, largest, 1.1 * largest, 2.0 * largest] {
            let (step, tries) = found(guess, |step| step * step / 24.0);
            assert!(step <= largest && step > largest * (1.0 - off), "{step} {largest}");
            assert!(tries <= 3, "{tries}");
        }
    }

    #[test]
    fn the_least_is_returned_where_nothing_holds_and_the_most_where_all_does() {
        assert_eq!(found(1.0, |_| 5.0).0, 0.01);
        assert_eq!(found(1.0, |_| 0.0).0, 10.0);
    }

    #[test]
    fn a_leap_is_approached_from_below() {
        for leap in [0.02, 0.3, 1.3, 7.0] {
            let (step, tries) = found(1.0, |step| if step <= leap { 0.01 } else { 2.0 });
            assert!(step <= leap && step >= 0.4 * leap, "{step} of {leap}");
            assert!(tries <= TRIES + 1);
        }
    }

    #[test]
    fn noise_terminates_and_holds() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..200 {
            let noise: Vec<f64> = (0..64).map(|_| random.f64() * 0.2).collect();
            let scallop = |step: f64| noise[(step * 6.0) as usize % 64] * step;
            let (step, _) = found(random.f64() * 10.0, scallop);
            assert!(scallop(step) <= 0.08 || step == 0.01);
        }
    }
}
