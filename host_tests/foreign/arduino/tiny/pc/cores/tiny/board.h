/* Simulated time since power-on [s]. */
#pragma once

double board_seconds();
