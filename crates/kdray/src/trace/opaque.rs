//! Where the compiler must not see more than it is told.

use std::arch::asm;

/// The same reference, of which the compiler does not know what it refers to.
#[inline(always)]
#[expect(clippy::pointers_in_nomem_asm_block, reason = "nothing is read through it there")]
pub(super) fn opaque<T>(of: &T) -> &T {
    let mut address = std::ptr::from_ref(of);
    // SAFETY: the address stays what it was.
    unsafe {
        asm!("/* {0} */", inout(reg) address, options(pure, nomem, nostack, preserves_flags));
        &*address
    }
}
