/* The second stage of the boot, which the boot ROM copies from the first 256 bytes of the flash to
   SRAM and enters there with lr = 0 (RP2040 datasheet, 2.8.1.3). Its last four bytes are a checksum
   that toolchains/images/rp2040_image.py fills in.

   It maps the flash by the serial read 03h, which every NOR flash has: slow to fetch, and there is
   nothing to know about the chip. SSI registers: datasheet, 4.10.13. Position independent. */
    .syntax unified
    .cpu cortex-m0plus
    .thumb
    .section .boot2, "ax"
    .global boot2
    .type boot2, %function
    .thumb_func
boot2:
    ldr  r3, =0x18000000      /* XIP_SSI_BASE */
    movs r1, #0
    str  r1, [r3, #0x08]      /* SSIENR: off while it is set up */
    movs r1, #4
    str  r1, [r3, #0x14]      /* BAUDR: a quarter of clk_sys, 31 MHz; 03h is good for 50 */
    ldr  r1, =0x001f0300      /* CTRLR0: frames of 32 bits, EEPROM read, one line */
    str  r1, [r3, #0x00]
    ldr  r1, =0x03000218      /* SPI_CTRLR0: command 03h of 8 bits, address of 24, no wait */
    ldr  r0, =0x180000f4
    str  r1, [r0]
    movs r1, #0
    str  r1, [r3, #0x04]      /* CTRLR1: one frame a read */
    movs r1, #1
    str  r1, [r3, #0x08]      /* SSIENR: on; the flash is memory at 0x10000000 from here */
    ldr  r0, =vectors
    ldr  r1, =0xe000ed08      /* VTOR */
    str  r0, [r1]
    ldr  r1, [r0, #0]
    msr  msp, r1
    ldr  r0, [r0, #4]
    bx   r0
    .align 2
    .ltorg
