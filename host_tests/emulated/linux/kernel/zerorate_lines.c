// SPDX-License-Identifier: GPL-2.0-only
/*
 * For tests only: a GPIO chip of eight inputs. A process drives them by writing "LINE LEVEL" to
 * /dev/zerorate_lines; edges are interrupts, so that the kernel's character device stamps them.
 */
#include <linux/gpio/driver.h>
#include <linux/interrupt.h>
#include <linux/irq.h>
#include <linux/irqdomain.h>
#include <linux/miscdevice.h>
#include <linux/module.h>
#include <linux/of.h>
#include <linux/platform_device.h>
#include <linux/uaccess.h>

#include "host_tests/emulated/linux/kernel/zerorate_bus.h"

#define LINES 8

static struct platform_device *parent;
static unsigned long level, rising, falling, enabled;

static int line_direction(struct gpio_chip *chip, unsigned int line)
{
	return GPIO_LINE_DIRECTION_IN;
}

static int line_input(struct gpio_chip *chip, unsigned int line)
{
	return 0;
}

static int line_get(struct gpio_chip *chip, unsigned int line)
{
	return test_bit(line, &level);
}

static const char *const names[LINES] = { "GYRO_DRDY", "ODOMETER" };

static struct gpio_chip lines = {
	.label = "zerorate_lines",
	.owner = THIS_MODULE,
	.base = -1,
	.ngpio = LINES,
	.names = names,
	.get_direction = line_direction,
	.direction_input = line_input,
	.get = line_get,
};

static void line_mask(struct irq_data *data)
{
	clear_bit(irqd_to_hwirq(data), &enabled);
	gpiochip_disable_irq(&lines, irqd_to_hwirq(data));
}

static void line_unmask(struct irq_data *data)
{
	gpiochip_enable_irq(&lines, irqd_to_hwirq(data));
	set_bit(irqd_to_hwirq(data), &enabled);
}

static int line_type(struct irq_data *data, unsigned int type)
{
	if (type & ~IRQ_TYPE_EDGE_BOTH)
		return -EINVAL;
	assign_bit(irqd_to_hwirq(data), &rising, type & IRQ_TYPE_EDGE_RISING);
	assign_bit(irqd_to_hwirq(data), &falling, type & IRQ_TYPE_EDGE_FALLING);
	return 0;
}

static const struct irq_chip line_interrupts = {
	.name = "zerorate_lines",
	.irq_mask = line_mask,
	.irq_unmask = line_unmask,
	.irq_set_type = line_type,
	.flags = IRQCHIP_IMMUTABLE,
	GPIOCHIP_IRQ_RESOURCE_HELPERS,
};

static void drive(unsigned int line, bool high)
{
	unsigned long flags;

	if (test_bit(line, &level) == high)
		return;
	assign_bit(line, &level, high);
	if (!test_bit(line, &enabled) || !test_bit(line, high ? &rising : &falling))
		return;
	local_irq_save(flags);
	generic_handle_domain_irq_safe(lines.irq.domain, line);
	local_irq_restore(flags);
}

/* The interrupt of a line, of rising edges, as a device tree gives it to the driver of a chip. */
int zerorate_lines_irq(unsigned int line)
{
	int irq = irq_create_mapping(lines.irq.domain, line);

	if (irq)
		irq_set_irq_type(irq, IRQ_TYPE_EDGE_RISING);
	return irq ? irq : -ENXIO;
}
EXPORT_SYMBOL_GPL(zerorate_lines_irq);

static ssize_t world_write(struct file *file, const char __user *from, size_t size, loff_t *offset)
{
	char text[16] = "";
	unsigned int line, high;

	if (size >= sizeof(text))
		return -EINVAL;
	if (copy_from_user(text, from, size))
		return -EFAULT;
	if (sscanf(text, "%u %u", &line, &high) != 2 || line >= LINES)
		return -EINVAL;
	drive(line, high);
	return size;
}

static const struct file_operations world_operations = {
	.owner = THIS_MODULE,
	.write = world_write,
};

static struct miscdevice world = {
	.minor = MISC_DYNAMIC_MINOR,
	.name = "zerorate_lines",
	.fops = &world_operations,
};

static int __init zerorate_lines_init(void)
{
	int error;

	parent = platform_device_register_simple("zerorate_lines", -1, NULL, 0);
	if (IS_ERR(parent))
		return PTR_ERR(parent);
	lines.parent = &parent->dev;
	lines.fwnode = of_fwnode_handle(of_find_compatible_node(NULL, NULL, "zerorate,lines"));
	gpio_irq_chip_set_chip(&lines.irq, &line_interrupts);
	lines.irq.handler = handle_simple_irq;
	lines.irq.default_type = IRQ_TYPE_NONE;
	error = gpiochip_add_data(&lines, NULL);
	if (error)
		goto no_chip;
	error = misc_register(&world);
	if (!error)
		return 0;
	gpiochip_remove(&lines);
no_chip:
	platform_device_unregister(parent);
	return error;
}

static void __exit zerorate_lines_exit(void)
{
	misc_deregister(&world);
	gpiochip_remove(&lines);
	platform_device_unregister(parent);
}

module_init(zerorate_lines_init);
module_exit(zerorate_lines_exit);
MODULE_LICENSE("GPL");
MODULE_DESCRIPTION("for tests: GPIO lines that a process drives");
