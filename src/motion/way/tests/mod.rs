mod search;
mod straight;
mod worlds;
