/* Products and sums in single precision for the Cortex-M0+, in place of libgcc's: the names are those of
   the Arm run-time ABI (IHI 0043, table 7). The algorithm is that of soft_float.hpp, on normal numbers
   with normal results; for the rest it is called. Operands in r0 and r1, the result in r0.

   A significand stands at the top of a word: its one before the point in bit 31, eight places below the
   24 that remain. Rounding to nearest adds the highest bit that is cut off, which a shift leaves in the
   carry, and in a tie clears the lowest that remains. */
    .syntax unified
    .cpu cortex-m0plus
    .thumb

/* r0 = r0 + significand \s >> \places, rounded; \tie holds the bits that are cut off at the top of the
   word, and any that were lost before somewhere below. Returns. */
    .macro round_and_return s, places, tie, registers:vararg
    lsrs  \s, \s, #\places
    adcs  r0, r0, \s
    lsls  \tie, \tie, #1          /* a tie: nothing but the highest bit */
    bne   1f
    bcc   1f
    lsrs  r0, r0, #1
    lsls  r0, r0, #1
1:  pop   {\registers, pc}
    .endm

    .section .text.__aeabi_fmul, "ax"
    .global __aeabi_fmul
    .type __aeabi_fmul, %function
    .thumb_func
__aeabi_fmul:
    push  {r4-r7, lr}
    lsls  r2, r0, #1
    lsrs  r2, r2, #24             /* exponents: 1 to 254, or it is no normal number */
    subs  r2, #1
    cmp   r2, #253
    bhi   .Lmultiply_rare
    lsls  r3, r1, #1
    lsrs  r3, r3, #24
    subs  r3, #1
    cmp   r3, #253
    bhi   .Lmultiply_rare
    adds  r2, r2, r3
    subs  r2, #126                /* of a product below 2, less one */
    cmp   r2, #252
    bhi   .Lmultiply_rare
    movs  r4, r0
    eors  r4, r1
    lsrs  r4, r4, #31
    lsls  r4, r4, #8
    adds  r2, r2, r4              /* sign and exponent */
    movs  r3, #1
    lsls  r3, r3, #15
    uxtb  r5, r0                  /* 8 low bits and 16 high ones of each */
    lsls  r0, r0, #9
    lsrs  r0, r0, #17
    adds  r0, r0, r3
    uxtb  r6, r1
    lsls  r1, r1, #9
    lsrs  r1, r1, #17
    adds  r1, r1, r3
    movs  r7, r5
    muls  r7, r6                  /* low */
    muls  r6, r0
    muls  r5, r1
    muls  r1, r0                  /* high */
    adds  r6, r6, r5              /* middle */
    lsrs  r5, r7, #8
    adds  r6, r6, r5
    orrs  r7, r6
    lsls  r7, r7, #24
    lsrs  r7, r7, #8              /* what is lost, somewhere below bit 24 */
    lsrs  r6, r6, #8
    adds  r1, r1, r6              /* the product's upper 32 bits: from 2^30 on */
    bmi   .Ltwo_or_more
    lsls  r0, r2, #23
    lsls  r2, r1, #25
    orrs  r2, r7
    round_and_return r1, 7, r2, r4-r7
.Ltwo_or_more:
    adds  r2, #1
    lsls  r0, r2, #23
    lsls  r2, r1, #24
    orrs  r2, r7
    round_and_return r1, 8, r2, r4-r7
.Lmultiply_rare:
    bl    zerorate_multiply
    pop   {r4-r7, pc}

    .section .text.__aeabi_fadd, "ax"
    .global __aeabi_fsub
    .type __aeabi_fsub, %function
    .thumb_func
__aeabi_fsub:
    movs  r2, #1
    lsls  r2, r2, #31
    eors  r1, r2
    .global __aeabi_fadd
    .type __aeabi_fadd, %function
    .thumb_func
__aeabi_fadd:
    push  {r4-r7, lr}
    lsls  r2, r0, #1
    lsls  r3, r1, #1
    cmp   r2, r3
    bhs   .Lordered
    movs  r4, r0                  /* the larger first */
    movs  r0, r1
    movs  r1, r4
    movs  r4, r2
    movs  r2, r3
    movs  r3, r4
.Lordered:
    lsrs  r3, r3, #24             /* exponents: 1 to 253, or it is no normal number or near infinity */
    beq   .Ladd_rare
    lsrs  r2, r2, #24
    cmp   r2, #254
    bhs   .Ladd_rare
    subs  r3, r2, r3              /* places to shift: a register counts to 255 */
    movs  r4, r0
    eors  r4, r1                  /* negative: a difference */
    movs  r5, #1
    lsls  r5, r5, #31
    lsls  r1, r1, #8
    orrs  r1, r5
    lsls  r6, r0, #8
    orrs  r6, r5
    movs  r5, r1
    lsrs  r1, r3
    movs  r7, r1
    lsls  r7, r3
    cmp   r7, r5
    beq   .Laligned
    lsrs  r1, r1, #1              /* what is lost counts into the lowest bit */
    lsls  r1, r1, #1
    adds  r1, #1
.Laligned:
    cmp   r4, #0
    bmi   .Ldifference
    lsrs  r0, r0, #23             /* sign and exponent */
    adds  r6, r6, r1
    bcs   .Lcarried
    subs  r0, #1
    lsls  r0, r0, #23
    lsls  r3, r6, #24
    round_and_return r6, 8, r3, r4-r7
.Lcarried:
    adds  r0, #1
    lsls  r0, r0, #23
    lsls  r3, r6, #23
    round_and_return r6, 9, r3, r4-r7
.Ldifference:
    subs  r6, r6, r1
    beq   .Lzero
    bmi   .Lnormal
.Lshift:
    subs  r2, #1
    lsls  r6, r6, #1
    bpl   .Lshift
    cmp   r2, #0
    ble   .Lsubnormal
.Lnormal:
    lsrs  r0, r0, #31
    lsls  r0, r0, #8
    subs  r2, #1
    adds  r0, r0, r2
    lsls  r0, r0, #23
    lsls  r3, r6, #24
    round_and_return r6, 8, r3, r4-r7
.Lsubnormal:
    movs  r3, #9                  /* such a difference is exact */
    subs  r3, r3, r2
    lsrs  r6, r3
    lsrs  r0, r0, #31
    lsls  r0, r0, #31
    adds  r0, r0, r6
    pop   {r4-r7, pc}
.Lzero:
    movs  r0, #0
    pop   {r4-r7, pc}
.Ladd_rare:
    bl    zerorate_add
    pop   {r4-r7, pc}
