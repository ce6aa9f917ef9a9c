// Names of files and results as people read them.

/** `joint_2` as "joint 2". */
export const words = (name) => name.replaceAll("_", " ");
