"""Steps in which a joint's law changes, or swings on an end stop: in pieces that end where it changes.

Within a zone of its law (see joint_law) an axis moves smoothly, so a step is tried with the zones of its start. Where
the collocation's own polynomial leaves one, a piece ends there; the law is then that of the next zone, and
accelerations jump by what the mass matrix says:

    M Δa = -Δf,    Δa = -a of an axis that is held.

Each piece is a step of the same scheme, of the same order: the radiation memory is exact for any length, and what
the wave drives is a polynomial through its samples. On a stop, pieces follow the swing, and grow as far as the axis's
acceleration is a straight line.

As an axis meets its stop, the stop's damper loads the nodes of an elastic platform at once. Modes far faster than the
swing ring with a part of that load, and die early in the hit: the first pieces are such that smooth (see scheme), and
those after them are as long as the swing on a fixed platform asks for.

Middles and ends of pieces are put out beside the samples, with their weights in the means over the time between these:
a hit is shorter than that. Where a load may jump, so is what the next piece begins with.

Where a load jumps, all modes of an elastic platform ring, and those that a piece does not follow move the axis as no
polynomial tells: it would be caught while it moves, let go at another load, and damped by what Simpson's rule does not
see. From then on pieces are halved until they keep the energy balance and end where the law changes, and grow as far
as they keep it. Where a load only bends, the piece that ends there is halved if it would make it jump; and any piece
for which Newton's method fails, as from an acceleration that lasts microseconds.
"""
