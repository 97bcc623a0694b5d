# A rigid body that sounds: each impact strikes its object in ringdownd.
#
# Give the node this script, the name of an object that the daemon has loaded (ringdownd --object bell=bell.glb), and a
# collision shape. The body's own frame must be that of the mesh that the bank was baked from.
extends RigidBody3D

const Ringdown = preload("res://ringdown.gd")

# Impacts weaker than the force of rest in one step, times this, are not heard: a body that lies still presses, too.
const REST_FACTOR := 3.0

@export var object := "bell"
@export var contact_time := 0.0002

var ringdown: Ringdown


func _ready() -> void:
	contact_monitor = true
	max_contacts_reported = 4
	can_sleep = false
	if ringdown == null:
		ringdown = Ringdown.new()


# The collision callback: once for each physics step, with all contacts of it.
func _integrate_forces(state: PhysicsDirectBodyState3D) -> void:
	var at_rest := mass * state.total_gravity.length() * state.step
	for i in range(state.get_contact_count()):
		var impulse := state.get_contact_impulse(i).length()
		if impulse <= REST_FACTOR * at_rest:
			continue
		# Godot gives points and normals in the world's frame.
		var point := to_local(state.get_contact_collider_position(i))
		var direction := state.transform.basis.orthonormalized().inverse() * state.get_contact_local_normal(i)
		ringdown.strike(object, point, impulse * direction, contact_time)
