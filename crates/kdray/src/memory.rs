//! Large arrays in large pages.

/// A page of the size that processors translate in one step.
#[cfg(any(target_os = "linux", test))]
const HUGE_PAGE: usize = 2 << 20;

/// An empty vector with room for `capacity` elements, in huge pages where the system has them.
///
/// Trees are read in no order, so most reads of a large one miss the table of recently used pages;
/// with pages of 2 MiB that table covers the whole tree.
pub(crate) fn with_huge_pages<T>(capacity: usize) -> Vec<T> {
    let vector: Vec<T> = Vec::with_capacity(capacity);
    advise_huge_pages(vector.as_ptr().cast::<u8>(), capacity * size_of::<T>());
    vector
}

/// `count` zeros, in huge pages where the system has them.
pub(crate) fn zeros_in_huge_pages<T: bytemuck::Zeroable>(count: usize) -> Vec<T> {
    let vector: Vec<T> = bytemuck::allocation::zeroed_vec(count);
    advise_huge_pages(vector.as_ptr().cast::<u8>(), count * size_of::<T>());
    vector
}

/// Asks for huge pages within the bytes at `start`, which are zeros or were never used.
///
/// An allocator may give memory that was used before, in small pages: these are given back first.
#[cfg(target_os = "linux")]
fn advise_huge_pages(start: *const u8, bytes: usize) {
    let padding = start.align_offset(HUGE_PAGE);
    if padding >= bytes {
        return;
    }
    let bytes = (bytes - padding) / HUGE_PAGE * HUGE_PAGE;
    // That the system may not follow advice is no error.
    for advice in [libc::MADV_HUGEPAGE, libc::MADV_DONTNEED] {
        // SAFETY: the pages lie inside an allocation. What they hold may become zeros, which it is
        // already if it is anything.
        unsafe { libc::madvise(start.add(padding).cast_mut().cast(), bytes, advice) };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise_huge_pages(_start: *const u8, _bytes: usize) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_was_used_before_is_zeros_again() {
        const COUNT: usize = 3 * HUGE_PAGE / size_of::<u32>();
        for round in 1..20 {
            let used = vec![round; COUNT];
            assert_eq!(used[COUNT - 1], round);
            drop(used);
            let zeros: Vec<u32> = zeros_in_huge_pages(COUNT);
            assert!(zeros.iter().all(|number| *number == 0), "round {round}");
        }
    }
}
