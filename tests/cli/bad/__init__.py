"""Files with every kind of damage that a program may meet, made from a sound sample: the same
bytes on every run. What is known of each (how many atoms or triangles it holds, whether it means
the same as the sound one) comes with it."""
