/* A program with an instance of the sizes that it is compiled with. */
#include <stddef.h>
#include <zerorate.h>

static zerorate_node node;
static const zerorate_model model;

int main(void) {
  return zerorate_init(&node, &model, NULL) == ZERORATE_BAD_MODEL ? 0 : 1;
}
