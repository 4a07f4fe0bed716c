"""One file, one fault: sensor, navigation, actuator, timing."""
