/* r0: operation, r1: parameter; the answer comes in r0. */
    .syntax unified
    .cpu cortex-m0
    .thumb
    .section .text.zerorate_semihosting, "ax"
    .global zerorate_semihosting
    .type zerorate_semihosting, %function
    .thumb_func
zerorate_semihosting:
    bkpt  0xAB
    bx    lr
