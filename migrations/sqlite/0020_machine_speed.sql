-- How fast the machines are that workers run on, so that a plan can tell processor times. What a speed is, only the
-- simulation knows.
CREATE TABLE machine_speed (
    host            TEXT    NOT NULL,
    physics_version INTEGER NOT NULL,
    speed           TEXT    NOT NULL,
    measured        INTEGER NOT NULL,
    PRIMARY KEY (host, physics_version)
) STRICT;
