// SPDX-License-Identifier: GPL-2.0-only
/*
 * For tests only: an i2c_adapter and an spi_controller whose devices are a process behind
 * /dev/zerorate_bus. i2c-dev, spidev and the drivers of chips above them are the kernel's own.
 */
#include <linux/completion.h>
#include <linux/i2c.h>
#include <linux/miscdevice.h>
#include <linux/module.h>
#include <linux/mutex.h>
#include <linux/of.h>
#include <linux/platform_device.h>
#include <linux/slab.h>
#include <linux/spi/spi.h>
#include <linux/uaccess.h>
#include <linux/wait.h>

#include "host_tests/emulated/linux/kernel/zerorate_bus.h"

static int timeout_ms = 200;
module_param(timeout_ms, int, 0644);
MODULE_PARM_DESC(timeout_ms, "how long a transaction waits for its answer");

enum stage { STAGE_IDLE, STAGE_ASKED, STAGE_TAKEN, STAGE_ANSWERED };

struct exchange {
	struct mutex one_at_a_time;
	spinlock_t lock; /* guards stage */
	enum stage stage;
	bool is_open;
	wait_queue_head_t asked;
	struct completion answered;
	struct zerorate_bus_transaction head;
	struct zerorate_bus_answer answer;
	u32 size;
	u8 bytes[ZERORATE_BUS_BYTES];
};

static struct exchange bus;
static struct platform_device *parent;
static struct i2c_adapter adapter;
static struct spi_controller *controller;

static bool advance(enum stage from, enum stage to)
{
	bool moved;

	spin_lock(&bus.lock);
	moved = bus.stage == from;
	if (moved)
		bus.stage = to;
	spin_unlock(&bus.lock);
	return moved;
}

/* Hands the transaction in bus.head and bus.bytes over and waits. Under one_at_a_time. */
static int ask(void)
{
	if (!READ_ONCE(bus.is_open))
		return -ENXIO;
	reinit_completion(&bus.answered);
	WRITE_ONCE(bus.stage, STAGE_ASKED);
	wake_up_interruptible(&bus.asked);
	wait_for_completion_timeout(&bus.answered, msecs_to_jiffies(timeout_ms));
	if (!advance(STAGE_ANSWERED, STAGE_IDLE)) {
		WRITE_ONCE(bus.stage, STAGE_IDLE);
		return -ETIMEDOUT;
	}
	return bus.answer.status;
}

static void begin(u32 kind, u32 address)
{
	memset(&bus.head, 0, sizeof(bus.head));
	bus.head.bus = kind;
	bus.head.address = address;
	bus.size = 0;
}

static int add_segment(const void *written, u32 length, u32 direction)
{
	struct zerorate_bus_segment *segment;

	if (bus.head.segments == ZERORATE_BUS_SEGMENTS || bus.size + length > ZERORATE_BUS_BYTES)
		return -EMSGSIZE;
	segment = &bus.head.segment[bus.head.segments++];
	segment->length = length;
	segment->direction = direction;
	if (written)
		memcpy(bus.bytes + bus.size, written, length);
	else
		memset(bus.bytes + bus.size, 0, length);
	bus.size += length;
	return 0;
}

static int i2c_transfer_messages(struct i2c_adapter *from, struct i2c_msg *messages, int count)
{
	u32 at = 0;
	int i, error = 0;

	mutex_lock(&bus.one_at_a_time);
	begin(ZERORATE_BUS_I2C, messages[0].addr);
	for (i = 0; i < count && !error; i++) {
		bool is_read = messages[i].flags & I2C_M_RD;

		error = add_segment(is_read ? NULL : messages[i].buf, messages[i].len,
				    is_read ? ZERORATE_SEGMENT_READ : ZERORATE_SEGMENT_WRITE);
	}
	if (!error)
		error = ask();
	for (i = 0; i < count && !error; i++) {
		if (messages[i].flags & I2C_M_RD)
			memcpy(messages[i].buf, bus.bytes + at, messages[i].len);
		at += messages[i].len;
	}
	mutex_unlock(&bus.one_at_a_time);
	return error ? error : count;
}

static u32 i2c_functions(struct i2c_adapter *of)
{
	return I2C_FUNC_I2C | I2C_FUNC_SMBUS_EMUL;
}

static const struct i2c_algorithm algorithm = {
	.master_xfer = i2c_transfer_messages,
	.functionality = i2c_functions,
};

static int spi_transfer_message(struct spi_controller *from, struct spi_message *message)
{
	struct spi_transfer *transfer;
	u32 at = 0;
	int error = 0;

	mutex_lock(&bus.one_at_a_time);
	begin(ZERORATE_BUS_SPI, 0);
	bus.head.mode = message->spi->mode & (SPI_CPOL | SPI_CPHA);
	list_for_each_entry(transfer, &message->transfers, transfer_list) {
		u32 direction = (transfer->tx_buf ? ZERORATE_SEGMENT_WRITE : 0) |
				(transfer->rx_buf ? ZERORATE_SEGMENT_READ : 0);

		if (transfer->cs_change)
			direction |= ZERORATE_SEGMENT_LAST;

		bus.head.speed_hz = transfer->speed_hz;
		if (!error)
			error = add_segment(transfer->tx_buf, transfer->len, direction);
	}
	if (!error)
		error = ask();
	if (!error) {
		list_for_each_entry(transfer, &message->transfers, transfer_list) {
			if (transfer->rx_buf)
				memcpy(transfer->rx_buf, bus.bytes + at, transfer->len);
			at += transfer->len;
			message->actual_length += transfer->len;
		}
	}
	mutex_unlock(&bus.one_at_a_time);
	message->status = error;
	spi_finalize_current_message(from);
	return 0;
}

static int world_open(struct inode *inode, struct file *file)
{
	return xchg(&bus.is_open, true) ? -EBUSY : 0;
}

static int world_release(struct inode *inode, struct file *file)
{
	WRITE_ONCE(bus.is_open, false);
	return 0;
}

static ssize_t world_read(struct file *file, char __user *to, size_t size, loff_t *offset)
{
	int error = wait_event_interruptible(bus.asked, READ_ONCE(bus.stage) == STAGE_ASKED);

	if (error)
		return error;
	if (size < sizeof(bus.head) + bus.size)
		return -EMSGSIZE;
	if (copy_to_user(to, &bus.head, sizeof(bus.head)) ||
	    copy_to_user(to + sizeof(bus.head), bus.bytes, bus.size))
		return -EFAULT;
	return advance(STAGE_ASKED, STAGE_TAKEN) ? sizeof(bus.head) + bus.size : -EAGAIN;
}

static ssize_t world_write(struct file *file, const char __user *from, size_t size, loff_t *offset)
{
	if (READ_ONCE(bus.stage) != STAGE_TAKEN)
		return -ESTALE;
	if (size != sizeof(bus.answer) + bus.size)
		return -EINVAL;
	if (copy_from_user(&bus.answer, from, sizeof(bus.answer)) ||
	    copy_from_user(bus.bytes, from + sizeof(bus.answer), bus.size))
		return -EFAULT;
	if (!advance(STAGE_TAKEN, STAGE_ANSWERED))
		return -ESTALE;
	complete(&bus.answered);
	return size;
}

static const struct file_operations world_operations = {
	.owner = THIS_MODULE,
	.open = world_open,
	.release = world_release,
	.read = world_read,
	.write = world_write,
};

static struct miscdevice world = {
	.minor = MISC_DYNAMIC_MINOR,
	.name = "zerorate_bus",
	.fops = &world_operations,
};

static struct spi_device *spi_chip;
static struct i2c_client *i2c_chip;

/* A name from spidev's own table of devices, so that spidev binds to it. */
#define NAME_FOR_SPIDEV "dh2228fv"

/* Some drivers look nowhere but into the device tree: a chip gets the node that is compatible with its name. */
static struct device_node *node_of(const char *name)
{
	return of_find_compatible_node(NULL, NULL, name);
}

/* The core takes the name of a device from its node, without the vendor. */
static const char *without_vendor(const char *name)
{
	const char *comma = strchr(name, ',');

	return comma ? comma + 1 : name;
}

static int add_spi_chip(const char *name, int irq)
{
	struct spi_device *chip = spi_alloc_device(controller);
	int error;

	if (!chip)
		return -ENOMEM;
	chip->max_speed_hz = 10000000;
	chip->irq = irq; /* with a node, that of the node is taken */
	chip->dev.of_node = node_of(name);
	strscpy(chip->modalias, without_vendor(name), sizeof(chip->modalias));
	error = spi_add_device(chip);
	if (error) {
		of_node_put(chip->dev.of_node);
		spi_dev_put(chip);
		return error;
	}
	spi_chip = chip;
	return 0;
}

static int add_i2c_chip(const char *name, unsigned short address, int irq)
{
	struct i2c_board_info info = { .addr = address, .irq = irq };
	struct i2c_client *client;

	strscpy(info.type, without_vendor(name), sizeof(info.type));
	info.of_node = node_of(name);
	client = i2c_new_client_device(&adapter, &info);
	of_node_put(info.of_node);
	if (IS_ERR(client))
		return PTR_ERR(client);
	i2c_chip = client;
	return 0;
}

static void remove_chip(void)
{
	if (spi_chip)
		spi_unregister_device(spi_chip);
	i2c_unregister_device(i2c_chip);
	spi_chip = NULL;
	i2c_chip = NULL;
}

/* Another device in the place of the one before; its driver asks for the chip before this returns. */
static int set_chip(const char *text, const struct kernel_param *param)
{
	char kind[5] = "", name[2 * I2C_NAME_SIZE] = "";
	unsigned int address = 0;
	int line = -1, irq = 0;

	if (!controller)
		return -ENODEV;
	if (sscanf(text, "%4s %39s %x %d", kind, name, &address, &line) < 1)
		return -EINVAL;
	if (line >= 0)
		irq = zerorate_lines_irq(line);
	if (irq < 0)
		return irq;
	remove_chip();
	if (!strcmp(kind, "spi"))
		return add_spi_chip(name, irq);
	if (!strcmp(kind, "i2c"))
		return add_i2c_chip(name, address, irq);
	return strcmp(kind, "none") ? -EINVAL : 0;
}

static const struct kernel_param_ops chip_operations = { .set = set_chip };
module_param_cb(chip, &chip_operations, NULL, 0200);
MODULE_PARM_DESC(chip, "none, or spi|i2c NAME [ADDRESS [LINE]]: the device, and the line of its interrupt");

static int __init add_spi(void)
{
	int error;

	controller = spi_alloc_master(&parent->dev, 0);
	if (!controller)
		return -ENOMEM;
	controller->bus_num = 0;
	controller->num_chipselect = 1;
	controller->mode_bits = SPI_CPOL | SPI_CPHA;
	controller->bits_per_word_mask = SPI_BPW_MASK(8);
	controller->transfer_one_message = spi_transfer_message;
	error = spi_register_controller(controller);
	if (error) {
		spi_controller_put(controller);
		return error;
	}
	error = add_spi_chip(NAME_FOR_SPIDEV, 0);
	if (error)
		spi_unregister_controller(controller);
	return error;
}

static int __init zerorate_bus_init(void)
{
	int error;

	mutex_init(&bus.one_at_a_time);
	spin_lock_init(&bus.lock);
	init_waitqueue_head(&bus.asked);
	init_completion(&bus.answered);
	parent = platform_device_register_simple("zerorate_bus", -1, NULL, 0);
	if (IS_ERR(parent))
		return PTR_ERR(parent);
	adapter.owner = THIS_MODULE;
	adapter.algo = &algorithm;
	adapter.nr = 7;
	adapter.dev.parent = &parent->dev;
	strscpy(adapter.name, "zerorate test bus", sizeof(adapter.name));
	error = i2c_add_numbered_adapter(&adapter);
	if (error)
		goto no_adapter;
	error = add_spi();
	if (error)
		goto no_spi;
	error = misc_register(&world);
	if (!error)
		return 0;
	spi_unregister_controller(controller);
no_spi:
	i2c_del_adapter(&adapter);
no_adapter:
	platform_device_unregister(parent);
	return error;
}

static void __exit zerorate_bus_exit(void)
{
	misc_deregister(&world);
	remove_chip();
	spi_unregister_controller(controller);
	i2c_del_adapter(&adapter);
	platform_device_unregister(parent);
}

module_init(zerorate_bus_init);
module_exit(zerorate_bus_exit);
MODULE_LICENSE("GPL");
MODULE_DESCRIPTION("for tests: I2C and SPI devices that a process plays");
