#pragma once

#include "../plain_threads.hpp"
